// SPDX-License-Identifier: Apache-2.0
// Packs of eight for AVX-512; see pack_portable.h. The including file is compiled for that processor.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_PACK_AVX512_H
#define TETLAP_OVERLAP_GEO_FEATURES_PACK_AVX512_H

#define GEO_PACK 8
#define GEO_PACK_TEXT "avx512"
#define GEO_PACK_NAME(name) name##_avx512

#include <immintrin.h>
#include <math.h>

#include "overlap/geo/features/pack.h"

typedef __mmask8 PackMask;

static inline GeoPack pack_all(double x) {
  return (GeoPack)_mm512_set1_pd(x);
}
static inline GeoPack pack_load(const double *from) {
  return (GeoPack)_mm512_loadu_pd(from);
}
static inline void pack_store(double *to, GeoPack x) {
  _mm512_storeu_pd(to, (__m512d)x);
}
static inline PackMask pack_less(GeoPack a, GeoPack b) {
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
}
static inline PackMask pack_at_most(GeoPack a, GeoPack b) {
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
}
static inline PackMask pack_and(PackMask a, PackMask b) {
  return (PackMask)(a & b);
}
static inline PackMask pack_or(PackMask a, PackMask b) {
  return (PackMask)(a | b);
}
static inline PackMask pack_not(PackMask a) {
  return (PackMask)~a;
}
static inline unsigned pack_bits(PackMask mask) {
  return mask;
}
static inline GeoPack pack_select(PackMask mask, GeoPack yes, GeoPack no) {
  return (GeoPack)_mm512_mask_blend_pd(mask, (__m512d)no, (__m512d)yes);
}
static inline GeoPack pack_min(GeoPack a, GeoPack b) {
  return (GeoPack)_mm512_min_pd((__m512d)b, (__m512d)a);
}
static inline GeoPack pack_max(GeoPack a, GeoPack b) {
  return (GeoPack)_mm512_max_pd((__m512d)b, (__m512d)a);
}
static inline GeoPack pack_abs(GeoPack a) {
  return (GeoPack)_mm512_abs_pd((__m512d)a);
}
static inline GeoPack pack_sqrt(GeoPack a) {
  return (GeoPack)_mm512_sqrt_pd((__m512d)a);
}
// The lanes whose bits are set move to the front.
static inline GeoPack pack_compress(unsigned bits, GeoPack a) {
  return (GeoPack)_mm512_maskz_compress_pd((__mmask8)bits, (__m512d)a);
}
// Pairs of neighbours, pairs of pairs, halves.
static inline void pack_transpose(GeoPack rows[GEO_PACK]) {
  __m512d two[8], four[8];
  for (int i = 0; i < 8; i += 2) {
    two[i] = _mm512_unpacklo_pd((__m512d)rows[i], (__m512d)rows[i + 1]);
    two[i + 1] = _mm512_unpackhi_pd((__m512d)rows[i], (__m512d)rows[i + 1]);
  }
  for (int i = 0; i < 8; i += 4)
    for (int j = 0; j < 2; j++) {
      four[i + j] = _mm512_shuffle_f64x2(two[i + j], two[i + j + 2], 0x88);
      four[i + j + 2] = _mm512_shuffle_f64x2(two[i + j], two[i + j + 2], 0xdd);
    }
  for (int j = 0; j < 4; j++) {
    rows[j] = (GeoPack)_mm512_shuffle_f64x2(four[j], four[j + 4], 0x88);
    rows[j + 4] = (GeoPack)_mm512_shuffle_f64x2(four[j], four[j + 4], 0xdd);
  }
}

#endif
