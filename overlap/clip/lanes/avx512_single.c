// SPDX-License-Identifier: Apache-2.0
// Clipping with 16 pairs a vector.
#if defined(__x86_64__)
#include "overlap/clip/lanes.h"
#include "overlap/clip/polytope.h"

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")
#endif

#define LANES_SINGLE
#include "overlap/clip/lanes/vectors_avx512.inc"

#include "overlap/clip/answer.inc"

const OverlapClipLanes overlap_clip_lanes_avx512_single = {.name = "avx512, single",
                                                           .width = LANES,
                                                           .separate = separate,
                                                           .measure = measure,
                                                           .differentiate = differentiate,
                                                           .locate = locate};

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
