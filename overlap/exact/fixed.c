// SPDX-License-Identifier: Apache-2.0
#include "overlap/exact/fixed.h"

#include <stdint.h>
#include <stdlib.h>

enum { POINT = 127, LIMB = 64 };

static mp_limb_t limb_of(ExactInteger a, int k) {
  return k >= 0 && k < abs(a.size) ? a.limbs[k] : 0;
}

// ⌊|a| / 2^shift⌋ below 2^128; shift may be negative.
static ExactFixedNumber shifted(ExactInteger a, int shift) {
  const int low = shift >= 0 ? shift / LIMB : -((LIMB - 1 - shift) / LIMB), bit = shift - LIMB * low;
  const ExactFixedNumber two = (ExactFixedNumber)limb_of(a, low + 1) << LIMB | limb_of(a, low);
  return bit == 0 ? two : two >> bit | (ExactFixedNumber)limb_of(a, low + 2) << (2 * LIMB - bit);
}

static int bits_of(ExactInteger a) {
  const int size = abs(a.size);
  return LIMB * size - __builtin_clzll(a.limbs[size - 1]);
}

ExactFixed overlap_exact_fixed_from(const ExactInteger coordinate[3], ExactInteger weight) {
  ExactFixed fixed = {.bits = bits_of(weight)};
  for (int i = 0; i < 3; i++) fixed.coordinate[i] = shifted(coordinate[i], fixed.bits - POINT);
  return fixed;
}

static long double value_of(ExactFixedNumber f) {
  return (long double)(uint64_t)(f >> LIMB) * 0x1p64L + (long double)(uint64_t)f;
}

long double overlap_exact_fixed_weight(ExactInteger weight) {
  return value_of(shifted(weight, bits_of(weight) - POINT)) * 0x1p-127L;
}

bool overlap_exact_fixed_value(const ExactFixed *fixed, int i, long double *value) {
  *value = value_of(fixed->coordinate[i]) * 0x1p-127L;
  return fixed->coordinate[i] >> 63 != 0;
}

// Two's complement, least significant limb first.
typedef struct Wide {
  uint64_t limb[6];
} Wide;

static inline void add(Wide *sum, const uint64_t *term, int count, bool is_negative) {
  const uint64_t flip = is_negative ? UINT64_MAX : 0;
  ExactFixedNumber carry = is_negative;
  for (int k = 0; k < count; k++) {
    carry += (ExactFixedNumber)sum->limb[k] + (term[k] ^ flip);
    sum->limb[k] = (uint64_t)carry;
    carry >>= LIMB;
  }
}

static inline void multiply(ExactFixedNumber a, const uint64_t *b, int count, uint64_t *product) {
  const uint64_t low = (uint64_t)a, high = (uint64_t)(a >> LIMB);
  ExactFixedNumber carry = 0;
  for (int k = 0; k < count; k++) {
    carry += (ExactFixedNumber)low * b[k];
    product[k] = (uint64_t)carry;
    carry >>= LIMB;
  }
  product[count] = (uint64_t)carry, carry = 0;
  for (int k = 0; k < count; k++) {
    carry += (ExactFixedNumber)high * b[k] + product[k + 1];
    product[k + 1] = (uint64_t)carry;
    carry >>= LIMB;
  }
  product[count + 1] = (uint64_t)carry;
}

// sum ± a b
static inline void add_product(Wide *sum, ExactFixedNumber a, ExactFixedNumber b, bool is_negative) {
  const uint64_t factor[2] = {(uint64_t)b, (uint64_t)(b >> LIMB)};
  uint64_t product[4];
  multiply(a, factor, 2, product);
  add(sum, product, 4, is_negative);
}

// sum + a m with |m| < 2^255 in four limbs: what its sign bit stands for is taken off again.
static inline void add_multiple(Wide *sum, ExactFixedNumber a, const Wide *m) {
  uint64_t product[6];
  multiply(a, m->limb, 4, product);
  add(sum, product, 6, false);
  if (!(m->limb[3] >> 63)) return;
  const uint64_t excess[6] = {0, 0, 0, 0, (uint64_t)a, (uint64_t)(a >> LIMB)};
  add(sum, excess, 6, true);
}

bool overlap_exact_fixed_determinant(const ExactFixed *p, const ExactFixed *q, const ExactFixed *r,
                                     long double *determinant) {
  Wide sum = {{0}};
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    Wide minor = {{0}};
    add_product(&minor, q->coordinate[j], r->coordinate[k], false);
    add_product(&minor, r->coordinate[j], q->coordinate[k], true);
    add_multiple(&sum, p->coordinate[i], &minor);
  }
  const long double high = (long double)sum.limb[5] * 0x1p64L + (long double)sum.limb[4];
  *determinant = (high * 0x1p64L + (long double)sum.limb[3]) * 0x1p-189L; // 3 · 127 − 192 bits left out
  return sum.limb[5] != 0 && !(sum.limb[5] >> 63);
}
