// SPDX-License-Identifier: Apache-2.0
// Centre to second derivatives of a bundle of pairs for AVX2.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif

#include "overlap/geo/features/pack_avx2.h"

#include "overlap/geo/bundle/kernel.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
