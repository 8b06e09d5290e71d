// SPDX-License-Identifier: Apache-2.0
// Centre to second derivatives of a bundle of pairs for AVX-512.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")
#endif

#include "overlap/geo/features/pack_avx512.h"

#include "overlap/geo/bundle/kernel.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
