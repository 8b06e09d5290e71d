// SPDX-License-Identifier: GPL-3.0-or-later
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,fma,prefer-vector-width=512")
#endif

#define LANES_TEXT "avx512"
#define LANES_PACK 8
#define LANES_NAME(name) name##_avx512

#include "fem/lanes/kernels.inc"

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
