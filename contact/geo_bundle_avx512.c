// SPDX-License-Identifier: GPL-3.0-or-later
// Centre to second derivatives of a bundle of pairs for AVX-512.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")
#endif

#include "contact/geo_pack_avx512.h"

#pragma GCC diagnostic ignored "-Wunused-function" // of single pairs

#include "contact/geo_features_forward.inc"

#include "contact/geo_features_backward.inc"

#include "contact/geo_features_curve.inc"

#include "contact/geo_bundle_frame.inc"

#include "contact/geo_bundle_hessian.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
