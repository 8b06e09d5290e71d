// SPDX-License-Identifier: GPL-3.0-or-later
// When does the next contact begin? The smallest separation of the pairs that are watched.
//
// A pair is watched if both hold at the last update:
//   1. It is apart by more than a millionth of the margin. What touches has begun already: a root that has
//      just been found does not come again.
//   2. It does not merely widen a patch that is there: not both of its tetrahedra are, or share a vertex
//      with, members of engaged pairs (overlapping or touching) of the same two bodies, or the same body. A
//      patch that grows by its neighbours begins without a jump of the pressure; a new patch does not.
#ifndef TETLAP_CONTACT_ONSET_H
#define TETLAP_CONTACT_ONSET_H

#include "contact/search/candidates.h"

typedef struct ContactOnset {
  int count;
  ContactPair *watched; // (count)
  size_t capacity;
  unsigned char *is_engaged; // scratch, of each candidate
  size_t engaged_capacity;
  double (*boxes)[6];       // scratch, of the candidates' tetrahedra   (cell_count)
  unsigned char *is_marked; // scratch, 0 between calls      (position_count)
} ContactOnset;

Status contact_onset_create(ContactOnset *onset, const ContactLayout *layout);
void contact_onset_destroy(ContactOnset *onset);

// Chooses the watched pairs among the candidates. The `known` ones (known_count), in the candidates' order,
// are known to overlap at these positions; the answer is the same without them, but takes longer.
Status contact_onset_choose(ContactOnset *onset, const ContactLayout *layout,
                            const ContactCandidateList *candidates, const ContactPair *known, int known_count,
                            double time, const double *positions);

// The smallest separation of a watched pair [m], at most the margin.
double contact_onset_gap(const ContactOnset *onset, const ContactLayout *layout, double time,
                         const double *positions);

#endif
