// SPDX-License-Identifier: Apache-2.0
// Pairs whose tetrahedra share no volume, and those with a flat one, are answered by exactly 0, unasked: by
// the separating axis theorem (overlap/separation.h), where clipping finds no volume. V may jump where two
// begin to touch (fade.h). Every model of a user has this that does not say that its V is 0 there as it
// stands; `keep` leaves disjoint pairs to it. The model gets copies of its pairs.
#ifndef TETLAP_OVERLAP_WRAP_CUT_H
#define TETLAP_OVERLAP_WRAP_CUT_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_cut, overlap_wrap_keep;

#endif
