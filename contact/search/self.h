// SPDX-License-Identifier: GPL-3.0-or-later
// Self-contact: which cells (contact/surface/mesh.h) of a body may meet each other. They are pairs that
//   1. belong to tetrahedra without a common vertex: neighbours always touch;
//   2. do not overlap at rest by more than rounding: what overlaps in the mesh itself is never contact;
//   3. have a vertex on the surface, at least one of the two: others overlap only after a whole layer of
//      elements has gone through another, or where the interior is turned inside out.
// Bodies that do not meet themselves cost nothing here.
#ifndef TETLAP_CONTACT_SEARCH_SELF_H
#define TETLAP_CONTACT_SEARCH_SELF_H

#include "contact/def.h"
#include "contact/search/boxes.h"
#include "contact/search/broad.h"
#include "contact/surface/mesh.h"

typedef struct ContactSelf {
  int *outer; // tetrahedra of which a cell is outer; ascending                            (outer_count)
  int outer_count;
  int *cell_begin;          // the first cell of each tetrahedron                          (tet_count + 1)
  unsigned char *is_outer;  // of each cell: a vertex on the surface, of a body that meets itself (cell_count)
  ContactPairList left_out; // rule 2
} ContactSelf;

// `rest_depth` [m]: how deep a pair may overlap at rest and still count as apart. A zeroed one, and one whose
// creation failed, can be destroyed.
Status contact_self_create(ContactSelf *self, const ContactSystemDef *def, const ContactMesh *mesh,
                           double rest_depth);
void contact_self_destroy(ContactSelf *self);

// Appends the pairs (i < j, sorted) of cells of `body` that may meet and are apart by no more than
// `margin` at these positions.
Status contact_self_append(const ContactSelf *self, const ContactSystemDef *def, const ContactMesh *mesh,
                           int body, const double *positions, double margin, ContactPairList *list);

#endif
