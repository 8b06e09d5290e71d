// SPDX-License-Identifier: Apache-2.0
// Integers of any size for short straight-line computations: immutable values whose limbs lie one after
// another in memory that the caller lends (an arena). No allocation, no clean-up, no shared state. Of few
// limbs the arithmetic is our own, else GMP's mpn layer; this is the only place that knows GMP.
#ifndef TETLAP_OVERLAP_EXACT_INTEGER_H
#define TETLAP_OVERLAP_EXACT_INTEGER_H

#include <gmp.h>

// A number: |size| limbs, least significant first, the top one not 0; the sign of size is the number's.
typedef struct ExactInteger {
  const mp_limb_t *limbs; // borrowed, mostly from an arena
  int size;
} ExactInteger;

// Where results are put. What was made after a point in time is given back by setting `next` to what it was.
typedef struct ExactArena {
  mp_limb_t *next; // first free limb
  mp_limb_t *end;
} ExactArena;

static inline int overlap_exact_integer_sign(ExactInteger a) {
  return (a.size > 0) - (a.size < 0);
}
static inline ExactInteger overlap_exact_integer_negated(ExactInteger a) {
  return (ExactInteger){a.limbs, -a.size};
}
// a if sign > 0, −a if sign < 0.
static inline ExactInteger overlap_exact_integer_signed(ExactInteger a, int sign) {
  return (ExactInteger){a.limbs, sign < 0 ? -a.size : a.size};
}

ExactInteger overlap_exact_integer_add(ExactArena *arena, ExactInteger a, ExactInteger b);
ExactInteger overlap_exact_integer_sub(ExactArena *arena, ExactInteger a, ExactInteger b);
ExactInteger overlap_exact_integer_mul(ExactArena *arena, ExactInteger a, ExactInteger b);

ExactInteger overlap_exact_integer_sum(ExactArena *arena, const ExactInteger terms[4]);

// The sign of a − b, or any number of that sign.
int overlap_exact_integer_compare(ExactInteger a, ExactInteger b);

// a b − c d
ExactInteger overlap_exact_integer_minor(ExactArena *arena, ExactInteger a, ExactInteger b, ExactInteger c,
                                         ExactInteger d);
ExactInteger overlap_exact_integer_dot(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3]);
void overlap_exact_integer_cross(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3],
                                 ExactInteger result[3]);

// The largest e for which x is an integer times 2^e; x finite and not 0.
int overlap_exact_integer_exponent(double x);
// x / 2^exponent, which must be an integer.
ExactInteger overlap_exact_integer_from_double(ExactArena *arena, double x, int exponent);

// a / 2^(64 dropped), rounded: relative error below 2^-62 where long double has 64 bits or more.
long double overlap_exact_integer_value(ExactInteger a, int dropped);

#endif
