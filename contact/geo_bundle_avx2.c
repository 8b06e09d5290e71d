// SPDX-License-Identifier: GPL-3.0-or-later
// Centre to second derivatives of a bundle of pairs for AVX2.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif

#include "contact/geo_pack_avx2.h"

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
