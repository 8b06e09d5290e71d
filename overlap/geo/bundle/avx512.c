// SPDX-License-Identifier: Apache-2.0
// Centre to second derivatives of a bundle of pairs for AVX-512.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")
#endif

#include "overlap/geo/features/pack_avx512.h"

#pragma GCC diagnostic ignored "-Wunused-function" // of single pairs

#include <string.h>

#include "overlap/geo/features/features.h"

#pragma GCC diagnostic ignored "-Wpsabi" // packs are returned by inlined functions only

#include "overlap/geo/features/forward.inc"

#include "overlap/geo/features/change.inc"

#include "overlap/geo/features/backward.inc"

#include "overlap/geo/features/curve.inc"

#include "overlap/geo/bundle/frame.inc"

#include "overlap/geo/bundle/centroid.inc"

#include "overlap/geo/bundle/hessian.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
