// SPDX-License-Identifier: Apache-2.0
// Packs for any processor: two numbers, and the operations that vector types of C lack. Included by
// overlap/geo/bundle/*portable.c alone; pack_avx2.h and pack_avx512.h have the same operations.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_PACK_PORTABLE_H
#define TETLAP_OVERLAP_GEO_FEATURES_PACK_PORTABLE_H

#define GEO_PACK 2
#define GEO_PACK_TEXT "portable"
#define GEO_PACK_NAME(name) name##_portable

#include <math.h>

#include "overlap/geo/features/pack.h"

typedef long long PackMask __attribute__((vector_size(GEO_PACK * sizeof(long long))));

static inline GeoPack pack_all(double x) {
  return (GeoPack){x, x};
}
static inline GeoPack pack_load(const double *from) {
  return (GeoPack){from[0], from[1]};
}
static inline void pack_store(double *to, GeoPack x) {
  to[0] = x[0], to[1] = x[1];
}
static inline PackMask pack_less(GeoPack a, GeoPack b) {
  return (PackMask)(a < b);
}
static inline PackMask pack_at_most(GeoPack a, GeoPack b) {
  return (PackMask)(a <= b);
}
static inline PackMask pack_and(PackMask a, PackMask b) {
  return a & b;
}
static inline PackMask pack_or(PackMask a, PackMask b) {
  return a | b;
}
static inline PackMask pack_not(PackMask a) {
  return ~a;
}
static inline unsigned pack_bits(PackMask mask) {
  return (mask[0] ? 1U : 0U) | (mask[1] ? 2U : 0U);
}
static inline GeoPack pack_select(PackMask mask, GeoPack yes, GeoPack no) {
  return (GeoPack)(((PackMask)yes & mask) | ((PackMask)no & ~mask));
}
static inline GeoPack pack_min(GeoPack a, GeoPack b) {
  return pack_select((PackMask)(b < a), b, a);
}
static inline GeoPack pack_max(GeoPack a, GeoPack b) {
  return pack_select((PackMask)(b > a), b, a);
}
static inline GeoPack pack_abs(GeoPack a) {
  return (GeoPack){fabs(a[0]), fabs(a[1])};
}
static inline GeoPack pack_sqrt(GeoPack a) {
  return (GeoPack){sqrt(a[0]), sqrt(a[1])};
}
// The lanes whose bits are set move to the front.
static inline GeoPack pack_compress(unsigned bits, GeoPack a) {
  return bits == 2 ? (GeoPack){a[1], a[1]} : a;
}
static inline void pack_transpose(GeoPack rows[GEO_PACK]) {
  GeoPack first = {rows[0][0], rows[1][0]}, second = {rows[0][1], rows[1][1]};
  rows[0] = first, rows[1] = second;
}

#endif
