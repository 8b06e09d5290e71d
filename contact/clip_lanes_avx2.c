// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping with 4 pairs a vector.
#if defined(__x86_64__)
#include "contact/clip_lanes.h"
#include "contact/clip_polytope.h"

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif

#include "contact/lanes_avx2.inc"

#include "contact/clip_lanes.inc"

const ContactClipLanes contact_clip_lanes_avx2 = {
    .name = "avx2", .width = LANES, .separate = separate, .measure = measure, .differentiate = differentiate};

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
