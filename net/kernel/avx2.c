// SPDX-License-Identifier: Apache-2.0
// The kernel for processors with AVX2 and FMA: tiles of 6 × 2 vectors, 12 of the 16 registers accumulate.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#include <immintrin.h>
#include <stdint.h>

#include "net/kernel/kernel.h"

#define KERNEL_ROWS 6
#define KERNEL_OUTER 2

#include "net/real_f32.h"
#define KERNEL_NAME(name) name##_avx2_f32
#define KERNEL_VECTOR __m256
#define KERNEL_WIDTH 8

static inline __m256 vector_all_avx2_f32(float x) {
  return _mm256_set1_ps(x);
}
static inline __m256 vector_multiply_add_avx2_f32(__m256 a, __m256 b, __m256 c) {
  return _mm256_fmadd_ps(a, b, c);
}
static inline __m256 vector_rectify_avx2_f32(__m256 a) {
  return _mm256_max_ps(a, _mm256_setzero_ps());
}
static inline float vector_sum_avx2_f32(__m256 a) {
  __m128 four = _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
  __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}

#include "net/kernel/elementwise.inc"
#include "net/kernel/tiles.inc"

const NetKernel_f32 net_kernel_avx2_f32 = KERNEL_TABLE;

#include "net/real_f64.h"
#undef KERNEL_NAME
#undef KERNEL_VECTOR
#undef KERNEL_WIDTH
#define KERNEL_NAME(name) name##_avx2_f64
#define KERNEL_VECTOR __m256d
#define KERNEL_WIDTH 4

static inline __m256d vector_all_avx2_f64(double x) {
  return _mm256_set1_pd(x);
}
static inline __m256d vector_multiply_add_avx2_f64(__m256d a, __m256d b, __m256d c) {
  return _mm256_fmadd_pd(a, b, c);
}
static inline __m256d vector_rectify_avx2_f64(__m256d a) {
  return _mm256_max_pd(a, _mm256_setzero_pd());
}
static inline double vector_sum_avx2_f64(__m256d a) {
  __m128d two = _mm_add_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
  return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
}

#include "net/kernel/elementwise.inc"
#include "net/kernel/tiles.inc"

const NetKernel_f64 net_kernel_avx2_f64 = KERNEL_TABLE;
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
typedef int net_kernel_avx2_is_not_empty;
