// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase: which tetrahedra of different bodies may overlap, kept over several steps by a skin margin.
// Boxes are cut to the shared bounds of two bodies, grown by half the margin, and intersected
// (contact/search/boxes.h). As long as no vertex has moved by more than half the
// margin since the list was made, the list holds every overlapping pair.
#ifndef TETLAP_CONTACT_SEARCH_BROAD_H
#define TETLAP_CONTACT_SEARCH_BROAD_H

#include <stddef.h>

#include "base/status.h"

// Tetrahedra of one list against those of another; both borrowed.
typedef struct ContactBroadSide {
  const int (*tets)[4]; // vertices of its tetrahedra, into positions   (tet_count)
  int tet_count;
  int tet_offset; // added to an index to give the global number of a tetrahedron
} ContactBroadSide;

typedef struct ContactPairList {
  int count;
  size_t capacity;
  int (*pairs)[2]; // global tetrahedron numbers, first of side a, second of side b; sorted   (count)
} ContactPairList;

// Appends the candidate pairs of a and b at `positions` (vertex, 3), each box grown by `margin`/2 on all
// sides.
Status contact_broad_append(ContactPairList *list, const ContactBroadSide *a, const ContactBroadSide *b,
                            const double *positions, double margin);

void contact_broad_destroy(ContactPairList *list);

#endif
