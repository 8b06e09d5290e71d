// SPDX-License-Identifier: GPL-3.0-or-later
// Who of one body may meet the same body: pairs of its cells (contact/surface/depth.h) that
//   1. are of tetrahedra without a common vertex: topological neighbours meet always;
//   2. do not overlap at rest by more than rounding: what the mesh begins with is no contact, now or later;
//   3. have a vertex on the surface, one of the two at least: others only overlap once a whole layer of
//      elements has gone through another, or where the bulk itself is turned inside out.
// Bodies that do not meet themselves cost nothing here.
#ifndef TETLAP_CONTACT_SELF_H
#define TETLAP_CONTACT_SELF_H

#include "contact/def.h"
#include "contact/search/boxes.h"
#include "contact/search/broad.h"
#include "contact/surface/depth.h"

typedef struct ContactSelf {
  int *outer; // tetrahedra of which a cell is outer; ascending                            (outer_count)
  int outer_count;
  int *cell_begin;          // the first cell of each tetrahedron                          (tet_count + 1)
  unsigned char *is_outer;  // of each cell: a vertex on the surface, of a body that meets itself (cell_count)
  ContactPairList left_out; // rule 2
} ContactSelf;

// `rest_depth` [m]: how deep a pair may overlap at rest and still count as apart. A zeroed one, and one whose
// creation failed, can be destroyed.
Status contact_self_create(ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth,
                           double rest_depth);
void contact_self_destroy(ContactSelf *self);

// Appends the pairs (i < j, sorted) of cells of `body` that may meet and are apart by no more than
// `margin` at these positions.
Status contact_self_append(const ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth,
                           int body, const double *positions, double margin, ContactPairList *list);

#endif
