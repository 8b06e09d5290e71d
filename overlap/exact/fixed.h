// SPDX-License-Identifier: Apache-2.0
// A corner's homogeneous coordinates (c_0, c_1, c_2), all ≥ 0, with sum ≤ w, to 127 bits after the binary
// point: enough for all but the thinnest triangles, and known when not. With b the number of bits of w,
//
//     c = 2^(b − 127) (f + e),   f an integer, 0 ≤ e < 1,   Σ f ≤ 2^127
//
// so that the determinant of three corners, T of the c's in these units and F of the f's, differs by less
// than 2^256: replacing one row by its e changes it by e·(q × r) < |q|₁ |r|₁ ≤ 2^254 (1 + 2^-125).
#ifndef TETLAP_OVERLAP_EXACT_FIXED_H
#define TETLAP_OVERLAP_EXACT_FIXED_H

#include <stdbool.h>

#include "overlap/exact/integer.h"

__extension__ typedef unsigned __int128 ExactFixedNumber;

typedef struct ExactFixed {
  ExactFixedNumber coordinate[3]; // f
  int bits;                       // b
} ExactFixed;

// `weight` must be positive.
ExactFixed overlap_exact_fixed_from(const ExactInteger coordinate[3], ExactInteger weight);

// w / 2^b, from ½ to 1, rounded: relative error below 2^-62.
long double overlap_exact_fixed_weight(ExactInteger weight);

// c_i / 2^b where it is certain to a relative error of 2^-62: f ≥ 2^63, which leaves 2^-63 for e.
bool overlap_exact_fixed_value(const ExactFixed *fixed, int i, long double *value);

// The determinant over 2^(b_p + b_q + b_r) where it is certain to a relative error of 2^-62: F ≥ 2^320.
bool overlap_exact_fixed_determinant(const ExactFixed *p, const ExactFixed *q, const ExactFixed *r,
                                     long double *determinant);

#endif
