// SPDX-License-Identifier: Apache-2.0
// The kernel for processors with AVX-512: tiles of 8 × 2 vectors, 16 of the 32 registers accumulate.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma"))),         \
                             apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,prefer-vector-width=512")
#endif
#include <immintrin.h>
#include <stdint.h>

#include "net/kernel/kernel.h"

#define KERNEL_ROWS 8
#define KERNEL_OUTER 4

#include "net/real_f32.h"
#define KERNEL_NAME(name) name##_avx512_f32
#define KERNEL_VECTOR __m512
#define KERNEL_WIDTH 16

static inline __m512 vector_all_avx512_f32(float x) {
  return _mm512_set1_ps(x);
}
static inline __m512 vector_multiply_add_avx512_f32(__m512 a, __m512 b, __m512 c) {
  return _mm512_fmadd_ps(a, b, c);
}
static inline __m512 vector_rectify_avx512_f32(__m512 a) {
  return _mm512_max_ps(a, _mm512_setzero_ps());
}
static inline float vector_sum_avx512_f32(__m512 a) {
  return _mm512_reduce_add_ps(a);
}

#include "net/kernel/elementwise.inc"
#include "net/kernel/tiles.inc"

const NetKernel_f32 net_kernel_avx512_f32 = KERNEL_TABLE;

#include "net/real_f64.h"
#undef KERNEL_NAME
#undef KERNEL_VECTOR
#undef KERNEL_WIDTH
#define KERNEL_NAME(name) name##_avx512_f64
#define KERNEL_VECTOR __m512d
#define KERNEL_WIDTH 8

static inline __m512d vector_all_avx512_f64(double x) {
  return _mm512_set1_pd(x);
}
static inline __m512d vector_multiply_add_avx512_f64(__m512d a, __m512d b, __m512d c) {
  return _mm512_fmadd_pd(a, b, c);
}
static inline __m512d vector_rectify_avx512_f64(__m512d a) {
  return _mm512_max_pd(a, _mm512_setzero_pd());
}
static inline double vector_sum_avx512_f64(__m512d a) {
  return _mm512_reduce_add_pd(a);
}

#include "net/kernel/elementwise.inc"
#include "net/kernel/tiles.inc"

const NetKernel_f64 net_kernel_avx512_f64 = KERNEL_TABLE;
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
typedef int net_kernel_avx512_is_not_empty;
