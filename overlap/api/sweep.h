// SPDX-License-Identifier: Apache-2.0
// Which boxes of two sets overlap: sweep and prune in columns.
//
// The common bounds are cut across y and z into columns about two boxes wide, and each box is entered into
// all that it touches. In a column both sets are sorted by where they begin along x, and the two lists are
// walked together: whichever box begins next meets those of the other set that have begun and not ended
// (Baraff 1992 along one axis). A pair that shares several columns is taken in the first of them.
#ifndef TETLAP_OVERLAP_API_SWEEP_H
#define TETLAP_OVERLAP_API_SWEEP_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

typedef struct OverlapApiBox {
  double low[3], high[3];
} OverlapApiBox;

typedef struct OverlapApiCandidate {
  int32_t first, second; // numbers of boxes
} OverlapApiCandidate;

typedef struct OverlapApiCandidates {
  size_t count, capacity;
  OverlapApiCandidate *at; // sorted by first, then second; owned
} OverlapApiCandidates;

// Appends to an empty list the pairs whose boxes share an interior.
Status overlap_api_sweep_find(const OverlapApiBox *first, int first_count, const OverlapApiBox *second,
                              int second_count, OverlapApiCandidates *candidates);

void overlap_api_sweep_destroy(OverlapApiCandidates *candidates);

#endif
