// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/exact_integer.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static_assert(GMP_NUMB_BITS == 64, "limbs of 64 bits without nails");

static mp_limb_t *take(ExactArena *arena, int count) {
  mp_limb_t *limbs = arena->next;
  assert(arena->end - limbs >= count);
  arena->next = limbs + count;
  return limbs;
}

// The number in `limbs` (the last ones taken) without leading zeros; what it does not need is given back.
static ExactInteger finish(ExactArena *arena, mp_limb_t *limbs, int size, int sign) {
  while (size > 0 && limbs[size - 1] == 0) size--;
  arena->next = limbs + size;
  return (ExactInteger){limbs, sign < 0 ? -size : size};
}

// Gives back everything made since `mark` but `a`, which moves down to there.
static ExactInteger keep(ExactArena *arena, mp_limb_t *mark, ExactInteger a) {
  const int size = abs(a.size);
  for (int k = 0; k < size; k++) mark[k] = a.limbs[k];
  arena->next = mark + size;
  return (ExactInteger){mark, a.size};
}

ExactInteger exact_add(ExactArena *arena, ExactInteger a, ExactInteger b) {
  if (abs(a.size) < abs(b.size)) {
    const ExactInteger t = a;
    a = b, b = t;
  }
  if (b.size == 0) return a;
  const int size_a = abs(a.size), size_b = abs(b.size);
  mp_limb_t *sum = take(arena, size_a + 1);
  sum[size_a] = 0;
  if ((a.size > 0) == (b.size > 0)) {
    sum[size_a] = mpn_add(sum, a.limbs, size_a, b.limbs, size_b);
    return finish(arena, sum, size_a + 1, a.size);
  }
  if (size_a == size_b && mpn_cmp(a.limbs, b.limbs, size_a) < 0) {
    mpn_sub_n(sum, b.limbs, a.limbs, size_a);
    return finish(arena, sum, size_a, b.size);
  }
  mpn_sub(sum, a.limbs, size_a, b.limbs, size_b);
  return finish(arena, sum, size_a, a.size);
}

ExactInteger exact_sub(ExactArena *arena, ExactInteger a, ExactInteger b) {
  return exact_add(arena, a, exact_negated(b));
}

ExactInteger exact_mul(ExactArena *arena, ExactInteger a, ExactInteger b) {
  if (abs(a.size) < abs(b.size)) {
    const ExactInteger t = a;
    a = b, b = t;
  }
  if (b.size == 0) return b;
  const int size_a = abs(a.size), size_b = abs(b.size);
  mp_limb_t *product = take(arena, size_a + size_b);
  if (size_b == 1)
    product[size_a] = mpn_mul_1(product, a.limbs, size_a, b.limbs[0]);
  else
    mpn_mul(product, a.limbs, size_a, b.limbs, size_b);
  return finish(arena, product, size_a + size_b, (a.size > 0) == (b.size > 0) ? 1 : -1);
}

ExactInteger exact_minor(ExactArena *arena, ExactInteger a, ExactInteger b, ExactInteger c, ExactInteger d) {
  mp_limb_t *mark = arena->next;
  const ExactInteger ab = exact_mul(arena, a, b), cd = exact_mul(arena, c, d);
  return keep(arena, mark, exact_sub(arena, ab, cd));
}

ExactInteger exact_dot(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3]) {
  mp_limb_t *mark = arena->next;
  ExactInteger sum = exact_mul(arena, x[0], y[0]);
  sum = exact_add(arena, sum, exact_mul(arena, x[1], y[1]));
  sum = exact_add(arena, sum, exact_mul(arena, x[2], y[2]));
  return keep(arena, mark, sum);
}

void exact_cross(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3],
                 ExactInteger result[3]) {
  for (int c = 0; c < 3; c++) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    result[c] = exact_minor(arena, x[d], y[e], x[e], y[d]);
  }
}

// |x| = mantissa · 2^exponent with an odd mantissa.
static uint64_t decompose(double x, int *exponent) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  const int field = (int)(bits >> 52 & 0x7ff);
  uint64_t mantissa = bits & ((UINT64_C(1) << 52) - 1);
  if (field > 0) mantissa |= UINT64_C(1) << 52;
  const int zeros = __builtin_ctzll(mantissa);
  *exponent = (field > 0 ? field : 1) - 1075 + zeros;
  return mantissa >> zeros;
}

int exact_exponent(double x) {
  int exponent;
  decompose(x, &exponent);
  return exponent;
}

ExactInteger exact_from_double(ExactArena *arena, double x, int exponent) {
  if (x == 0) return (ExactInteger){arena->next, 0};
  int own;
  const uint64_t mantissa = decompose(x, &own);
  const int shift = own - exponent, low = shift / 64, bit = shift % 64;
  mp_limb_t *limbs = take(arena, low + 2);
  for (int k = 0; k < low; k++) limbs[k] = 0;
  limbs[low] = mantissa << bit;
  limbs[low + 1] = bit > 0 ? mantissa >> (64 - bit) : 0;
  return finish(arena, limbs, low + 2, x < 0 ? -1 : 1);
}

long double exact_value(ExactInteger a, int dropped) {
  // The top three limbs hold at least 129 bits; what is below them is far beyond the last place.
  const int size = abs(a.size), low = size > 3 ? size - 3 : 0;
  long double value = 0;
  for (int k = size - 1; k >= low; k--) value = value * 0x1p64L + (long double)a.limbs[k];
  if (low != dropped) value = ldexpl(value, 64 * (low - dropped));
  return a.size < 0 ? -value : value;
}
