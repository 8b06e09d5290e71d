// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of clipping, over numbers that count what is done with them. No branch of theirs depends on a
// pair, so every pair takes the same.
#include <cfloat>
#include <cmath>
#include <cstddef>

#include "count_operations.h"

static double operations;        // multiplications, additions, divisions, roots; fused ones twice
static double instructions_once; // fused ones once

struct Lanes {
  double value;
  Lanes() = default;
  Lanes(double a) : value(a) {}
  explicit operator double() const { return value; }
};
typedef bool Mask;

static Lanes counted(double value, int count) {
  operations += count;
  instructions_once += 1;
  return value;
}
static Lanes operator+(Lanes a, Lanes b) {
  return counted(a.value + b.value, 1);
}
static Lanes operator-(Lanes a, Lanes b) {
  return counted(a.value - b.value, 1);
}
static Lanes operator*(Lanes a, Lanes b) {
  return counted(a.value * b.value, 1);
}
static Lanes operator/(Lanes a, Lanes b) {
  return counted(a.value / b.value, 1);
}
[[maybe_unused]] static Lanes operator-(Lanes a) {
  return -a.value;
}
static Lanes &operator+=(Lanes &a, Lanes b) {
  return a = a + b;
}
[[maybe_unused]] static Lanes &operator-=(Lanes &a, Lanes b) {
  return a = a - b;
}
[[maybe_unused]] static Lanes &operator*=(Lanes &a, Lanes b) {
  return a = a * b;
}

// The words of kernels/one.inc.
#define INLINED [[maybe_unused]] static inline
INLINED Lanes lanes_splat(double a) {
  return a;
}
INLINED Lanes lanes_fma(Lanes a, Lanes b, Lanes c) {
  return counted(std::fma(a.value, b.value, c.value), 2);
}
INLINED Lanes lanes_fms(Lanes a, Lanes b, Lanes c) {
  return counted(std::fma(a.value, b.value, -c.value), 2);
}
INLINED Lanes lanes_min(Lanes a, Lanes b) {
  return a.value < b.value ? a : b;
}
INLINED Lanes lanes_max(Lanes a, Lanes b) {
  return a.value > b.value ? a : b;
}
INLINED Lanes lanes_abs(Lanes a) {
  return std::fabs(a.value);
}
INLINED Lanes lanes_sqrt(Lanes a) {
  return counted(std::sqrt(a.value), 1);
}
INLINED Mask lanes_none(void) {
  return false;
}
INLINED Mask lanes_less(Lanes a, Lanes b) {
  return a.value < b.value;
}
INLINED Mask lanes_at_most(Lanes a, Lanes b) {
  return a.value <= b.value;
}
INLINED Mask lanes_equal(Lanes a, Lanes b) {
  return a.value == b.value;
}
INLINED Mask lanes_either(Mask a, Mask b) {
  return a || b;
}
INLINED Mask lanes_both(Mask a, Mask b) {
  return a && b;
}
INLINED Mask lanes_differ(Mask a, Mask b) {
  return a != b;
}
INLINED Lanes lanes_select(Mask mask, Lanes yes, Lanes no) {
  return mask ? yes : no;
}
INLINED unsigned lanes_bits(Mask mask) {
  return mask ? 1U : 0U;
}
INLINED Lanes lanes_nearer(Lanes a, Lanes b) {
  return lanes_min(lanes_abs(a), lanes_abs(b));
}
INLINED Lanes lanes_raise(Lanes a, Mask mask, Lanes b) {
  return mask ? lanes_max(b, a) : a;
}
INLINED Lanes lanes_lower(Lanes a, Mask unless, Lanes b) {
  return unless ? a : lanes_min(a, b);
}

#define KERNEL(items, name, ...) static void name(const int GROUP, __VA_ARGS__)
#define GLOBAL
#define SHARED
#define GROUP_MEMORY
#define CONSTANT static const
#define UNROLLED
#define ROLLED
#define ITEMS(item, count) for (int item = 0; item < (count); item++)
#define FORGET_KEPT (void)0
#define COUNT_UP(counter) (*(counter))++
#define uchar unsigned char

#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include "overlap/clip/constants.h"

#include "device/kernels/clip/kept.inc"

#include "overlap/clip/lanes.inc"

#include "device/kernels/pairs.inc"

#include "device/kernels/clip/clip.inc"

extern "C" void count_operations(const double pair[24], double counts[3], double instructions[3]) {
  double volume, more[24];
  unsigned char flags;
  int doubtful, doubtful_count = 0;
  for (int quantity = 0; quantity < 3; quantity++) {
    operations = instructions_once = 0;
    if (quantity == 0)
      clip_volume(0, PAIRS_ROWS, 1, 1, pair, nullptr, nullptr, 0, nullptr, &volume, &flags, &doubtful,
                  &doubtful_count);
    else
      (quantity == 1 ? clip_gradient : clip_centroid)(0, PAIRS_ROWS, 1, 1, pair, nullptr, nullptr, 0, nullptr,
                                                      &volume, &flags, &doubtful, &doubtful_count, more);
    counts[quantity] = operations;
    instructions[quantity] = instructions_once;
  }
}
