// SPDX-License-Identifier: Apache-2.0
#include "overlap/exact/integer.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static_assert(GMP_NUMB_BITS == 64, "limbs of 64 bits without nails");

static mp_limb_t *allocate_limbs(ExactArena *arena, int count) {
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
static ExactInteger release_above(ExactArena *arena, mp_limb_t *mark, ExactInteger a) {
  const int size = abs(a.size);
  for (int k = 0; k < size; k++) mark[k] = a.limbs[k];
  arena->next = mark + size;
  return (ExactInteger){mark, a.size};
}

// --- short numbers
//
// Ordinary coordinates have one or two limbs, so that a call of mpn costs more than its arithmetic: sums and
// products of few limbs are taken here in two's complement, each of lengths that the compiler knows.

#define INLINED static inline __attribute__((always_inline))

__extension__ typedef unsigned __int128 Double;

INLINED bool is_short(ExactInteger a, int limbs) {
  return a.size <= limbs && -a.size <= limbs;
}

INLINED mp_limb_t limb_of(ExactInteger a, int k) {
  return k < abs(a.size) ? a.limbs[k] : 0;
}

// sum ± term, `count` limbs each.
INLINED void accumulate(mp_limb_t *sum, const mp_limb_t *term, int count, bool is_negative) {
  const mp_limb_t flip = is_negative ? ~(mp_limb_t)0 : 0;
  Double carry = is_negative;
  for (int k = 0; k < count; k++) {
    carry += (Double)sum[k] + (term[k] ^ flip);
    sum[k] = (mp_limb_t)carry;
    carry >>= 64;
  }
}

// |a| |b| of `rows` and `columns` limbs.
INLINED void multiply(mp_limb_t *product, ExactInteger a, int rows, ExactInteger b, int columns) {
  for (int k = 0; k < columns; k++) product[k] = 0;
  for (int i = 0; i < rows; i++) {
    const mp_limb_t limb = limb_of(a, i);
    Double carry = 0;
    for (int k = 0; k < columns; k++) {
      carry += (Double)limb * limb_of(b, k) + product[i + k];
      product[i + k] = (mp_limb_t)carry;
      carry >>= 64;
    }
    product[i + columns] = (mp_limb_t)carry;
  }
}

// The number that `sum` is in two's complement.
INLINED ExactInteger write_number(ExactArena *arena, const mp_limb_t *sum, int count) {
  const bool is_negative = sum[count - 1] >> 63;
  mp_limb_t *limbs = allocate_limbs(arena, count);
  for (int k = 0; k < count; k++) limbs[k] = 0;
  accumulate(limbs, sum, count, is_negative);
  return finish(arena, limbs, count, is_negative ? -1 : 1);
}

enum { MOST = 8 };

INLINED ExactInteger sum_short(ExactArena *arena, const ExactInteger *terms, int count, int limbs) {
  mp_limb_t sum[MOST] = {0};
  for (int t = 0; t < count; t++) {
    mp_limb_t term[MOST];
    for (int k = 0; k < limbs; k++) term[k] = limb_of(terms[t], k);
    term[limbs] = 0;
    accumulate(sum, term, limbs + 1, terms[t].size < 0);
  }
  return write_number(arena, sum, limbs + 1);
}

INLINED void add_product(mp_limb_t *sum, ExactInteger a, int rows, ExactInteger b, int columns,
                         bool is_minus) {
  mp_limb_t product[MOST];
  multiply(product, a, rows, b, columns);
  product[rows + columns] = 0;
  accumulate(sum, product, rows + columns + 1, ((a.size < 0) != (b.size < 0)) != is_minus);
}

INLINED ExactInteger minor_short(ExactArena *arena, ExactInteger a, ExactInteger b, ExactInteger c,
                                 ExactInteger d, int limbs) {
  mp_limb_t sum[MOST] = {0};
  add_product(sum, a, limbs, b, limbs, false);
  add_product(sum, c, limbs, d, limbs, true);
  return write_number(arena, sum, 2 * limbs + 1);
}

INLINED ExactInteger dot_short(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3], int rows,
                               int columns) {
  mp_limb_t sum[MOST] = {0};
  for (int c = 0; c < 3; c++) add_product(sum, x[c], rows, y[c], columns, false);
  return write_number(arena, sum, rows + columns + 1);
}

// The limbs that the longest of them has.
INLINED int longest(const ExactInteger *numbers, int count) {
  int size = 0;
  for (int k = 0; k < count; k++)
    if (!is_short(numbers[k], size)) size = abs(numbers[k].size);
  return size;
}

// --- of any length

static ExactInteger add_long(ExactArena *arena, ExactInteger a, ExactInteger b) {
  if (abs(a.size) < abs(b.size)) {
    const ExactInteger t = a;
    a = b, b = t;
  }
  if (b.size == 0) return a;
  const int size_a = abs(a.size), size_b = abs(b.size);
  mp_limb_t *sum = allocate_limbs(arena, size_a + 1);
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

ExactInteger overlap_exact_integer_add(ExactArena *arena, ExactInteger a, ExactInteger b) {
  const ExactInteger terms[2] = {a, b};
  const int limbs = longest(terms, 2);
  if (limbs <= 1) return sum_short(arena, terms, 2, 1);
  return limbs <= 4 ? sum_short(arena, terms, 2, 4) : add_long(arena, a, b);
}

ExactInteger overlap_exact_integer_sub(ExactArena *arena, ExactInteger a, ExactInteger b) {
  return overlap_exact_integer_add(arena, a, overlap_exact_integer_negated(b));
}

ExactInteger overlap_exact_integer_sum(ExactArena *arena, const ExactInteger terms[4]) {
  const int limbs = longest(terms, 4);
  if (limbs <= 3) return sum_short(arena, terms, 4, 3);
  if (limbs <= 6) return sum_short(arena, terms, 4, 6);
  mp_limb_t *mark = arena->next;
  ExactInteger sum = overlap_exact_integer_add(arena, terms[0], terms[1]);
  sum = overlap_exact_integer_add(arena, sum, terms[2]);
  sum = overlap_exact_integer_add(arena, sum, terms[3]);
  return release_above(arena, mark, sum);
}

int overlap_exact_integer_compare(ExactInteger a, ExactInteger b) {
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  const int order = a.size == 0 ? 0 : mpn_cmp(a.limbs, b.limbs, abs(a.size));
  return a.size < 0 ? -order : order;
}

ExactInteger overlap_exact_integer_mul(ExactArena *arena, ExactInteger a, ExactInteger b) {
  if (abs(a.size) < abs(b.size)) {
    const ExactInteger t = a;
    a = b, b = t;
  }
  if (b.size == 0) return b;
  const int size_a = abs(a.size), size_b = abs(b.size);
  mp_limb_t *product = allocate_limbs(arena, size_a + size_b);
  if (size_b == 1)
    product[size_a] = mpn_mul_1(product, a.limbs, size_a, b.limbs[0]);
  else
    mpn_mul(product, a.limbs, size_a, b.limbs, size_b);
  return finish(arena, product, size_a + size_b, (a.size > 0) == (b.size > 0) ? 1 : -1);
}

ExactInteger overlap_exact_integer_minor(ExactArena *arena, ExactInteger a, ExactInteger b, ExactInteger c,
                                         ExactInteger d) {
  const int limbs = longest((const ExactInteger[]){a, b, c, d}, 4);
  if (limbs <= 1) return minor_short(arena, a, b, c, d, 1);
  if (limbs <= 2) return minor_short(arena, a, b, c, d, 2);
  mp_limb_t *mark = arena->next;
  const ExactInteger ab = overlap_exact_integer_mul(arena, a, b), cd = overlap_exact_integer_mul(arena, c, d);
  return release_above(arena, mark, overlap_exact_integer_sub(arena, ab, cd));
}

ExactInteger overlap_exact_integer_dot(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3]) {
  const int rows = longest(x, 3), columns = longest(y, 3);
  if (rows <= 1 && columns <= 2) return dot_short(arena, x, y, 1, 2);
  if (rows <= 2 && columns <= 4) return dot_short(arena, x, y, 2, 4);
  mp_limb_t *mark = arena->next;
  ExactInteger sum = overlap_exact_integer_mul(arena, x[0], y[0]);
  sum = overlap_exact_integer_add(arena, sum, overlap_exact_integer_mul(arena, x[1], y[1]));
  sum = overlap_exact_integer_add(arena, sum, overlap_exact_integer_mul(arena, x[2], y[2]));
  return release_above(arena, mark, sum);
}

void overlap_exact_integer_cross(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3],
                                 ExactInteger result[3]) {
  for (int c = 0; c < 3; c++) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    result[c] = overlap_exact_integer_minor(arena, x[d], y[e], x[e], y[d]);
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

int overlap_exact_integer_exponent(double x) {
  int exponent;
  decompose(x, &exponent);
  return exponent;
}

ExactInteger overlap_exact_integer_from_double(ExactArena *arena, double x, int exponent) {
  if (x == 0) return (ExactInteger){arena->next, 0};
  int own;
  const uint64_t mantissa = decompose(x, &own);
  const int shift = own - exponent, low = shift / 64, bit = shift % 64;
  mp_limb_t *limbs = allocate_limbs(arena, low + 2);
  for (int k = 0; k < low; k++) limbs[k] = 0;
  limbs[low] = mantissa << bit;
  limbs[low + 1] = bit > 0 ? mantissa >> (64 - bit) : 0;
  return finish(arena, limbs, low + 2, x < 0 ? -1 : 1);
}

long double overlap_exact_integer_value(ExactInteger a, int dropped) {
  // The top three limbs hold at least 129 bits; what is below them is far beyond the last place.
  const int size = abs(a.size), low = size > 3 ? size - 3 : 0;
  long double value = 0;
  for (int k = size - 1; k >= low; k--) value = value * 0x1p64L + (long double)a.limbs[k];
  if (low == dropped + 1)
    value *= 0x1p64L;
  else if (low != dropped)
    value = ldexpl(value, 64 * (low - dropped));
  return a.size < 0 ? -value : value;
}
