// SPDX-License-Identifier: Apache-2.0
// Features with eight numbers a register.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")
#endif

#include <string.h>

#include "overlap/geo/features/features.h"

#pragma GCC diagnostic ignored "-Wpsabi" // packs are returned by inlined functions only

#include "overlap/geo/features/forward.inc"

#include "overlap/geo/features/change.inc"

#include "overlap/geo/features/backward.inc"

#include "overlap/geo/features/bend.inc"

#include "overlap/geo/features/planes.inc"

const OverlapGeoKernel overlap_geo_features_kernel_avx512 = {
    .name = "avx512",
    .features = features,
    .planes = planes,
    .push = push,
    .push_planes = push_planes,
    .pull = pull,
    .bend = bend,
};

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
