// SPDX-License-Identifier: Apache-2.0
// What a handle of the C API (tetlap/overlap.h) is.
#ifndef TETLAP_OVERLAP_API_HANDLE_H
#define TETLAP_OVERLAP_API_HANDLE_H

#include <tetlap/overlap.h>

#include "overlap/model.h"

struct TetlapOverlap {
  OverlapModel model;
  int threads; // 0: as many as OpenMP would use
};

// Lets the calling thread's OpenMP regions have the handle's threads; returns how many it had.
int overlap_api_handle_enter(const TetlapOverlap *overlap);
void overlap_api_handle_leave(int threads);

#endif
