// SPDX-License-Identifier: GPL-3.0-or-later
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif

#define LANES_TEXT "avx2"
#define LANES_PACK 4
#define LANES_NAME(name) name##_avx2

#include "fem/lanes/kernels.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
