// SPDX-License-Identifier: Apache-2.0
// Functions of one number with two derivatives, of which shares and weights of pairs are made.
#ifndef TETLAP_OVERLAP_PAIR_BEND_H
#define TETLAP_OVERLAP_PAIR_BEND_H

// A function's value and two derivatives at one place.
typedef struct OverlapBend {
  double value, slope, bend;
} OverlapBend;

// The step S: from 0 for x ≤ 0 to 1 for x ≥ 1, x being a linear function of slope `rate`; NaN: 0. As S(1 − x)
// = 1 − S(x), it falls where x does.
static inline OverlapBend overlap_bend_rise(double x, double rate) {
  if (x >= 1) return (OverlapBend){.value = 1};
  if (!(x > 0)) return (OverlapBend){.value = 0};
  return (OverlapBend){x * x * (3 - 2 * x), 6 * x * (1 - x) * rate, 6 * (1 - 2 * x) * rate * rate};
}

#endif
