// SPDX-License-Identifier: Apache-2.0
// Packs of four for AVX2; see pack_portable.h. The including file is compiled for that processor.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_PACK_AVX2_H
#define TETLAP_OVERLAP_GEO_FEATURES_PACK_AVX2_H

#define GEO_PACK 4
#define GEO_PACK_TEXT "avx2"
#define GEO_PACK_NAME(name) name##_avx2

#include <immintrin.h>
#include <math.h>

#include "overlap/geo/features/pack.h"

typedef __m256d PackMask;

static inline GeoPack pack_all(double x) {
  return (GeoPack)_mm256_set1_pd(x);
}
static inline GeoPack pack_load(const double *from) {
  return (GeoPack)_mm256_loadu_pd(from);
}
static inline void pack_store(double *to, GeoPack x) {
  _mm256_storeu_pd(to, (__m256d)x);
}
static inline PackMask pack_less(GeoPack a, GeoPack b) {
  return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ);
}
static inline PackMask pack_at_most(GeoPack a, GeoPack b) {
  return _mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LE_OQ);
}
static inline PackMask pack_and(PackMask a, PackMask b) {
  return _mm256_and_pd(a, b);
}
static inline PackMask pack_or(PackMask a, PackMask b) {
  return _mm256_or_pd(a, b);
}
static inline PackMask pack_not(PackMask a) {
  return _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)));
}
static inline unsigned pack_bits(PackMask mask) {
  return (unsigned)_mm256_movemask_pd(mask);
}
static inline GeoPack pack_select(PackMask mask, GeoPack yes, GeoPack no) {
  return (GeoPack)_mm256_blendv_pd((__m256d)no, (__m256d)yes, mask);
}
static inline GeoPack pack_min(GeoPack a, GeoPack b) {
  return (GeoPack)_mm256_min_pd((__m256d)b, (__m256d)a);
}
static inline GeoPack pack_max(GeoPack a, GeoPack b) {
  return (GeoPack)_mm256_max_pd((__m256d)b, (__m256d)a);
}
static inline GeoPack pack_abs(GeoPack a) {
  return (GeoPack)_mm256_andnot_pd(_mm256_set1_pd(-0.0), (__m256d)a);
}
static inline GeoPack pack_sqrt(GeoPack a) {
  return (GeoPack)_mm256_sqrt_pd((__m256d)a);
}
// The lanes whose bits are set move to the front: a number is two halves for the permutation.
static inline GeoPack pack_compress(unsigned bits, GeoPack a) {
  int half[8] = {0}, count = 0;
  for (int lane = 0; lane < GEO_PACK; lane++)
    if (bits >> lane & 1) half[count++] = 2 * lane, half[count++] = 2 * lane + 1;
  __m256i index = _mm256_loadu_si256((const __m256i *)half);
  return (GeoPack)_mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps((__m256d)a), index));
}
static inline void pack_transpose(GeoPack rows[GEO_PACK]) {
  __m256d a = (__m256d)rows[0], b = (__m256d)rows[1], c = (__m256d)rows[2], d = (__m256d)rows[3];
  __m256d ab = _mm256_unpacklo_pd(a, b), ab_high = _mm256_unpackhi_pd(a, b);
  __m256d cd = _mm256_unpacklo_pd(c, d), cd_high = _mm256_unpackhi_pd(c, d);
  rows[0] = (GeoPack)_mm256_permute2f128_pd(ab, cd, 0x20);
  rows[1] = (GeoPack)_mm256_permute2f128_pd(ab_high, cd_high, 0x20);
  rows[2] = (GeoPack)_mm256_permute2f128_pd(ab, cd, 0x31);
  rows[3] = (GeoPack)_mm256_permute2f128_pd(ab_high, cd_high, 0x31);
}

#endif
