// SPDX-License-Identifier: Apache-2.0
// The words of kernels in plain C. A kernel is a function of the group's number.
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <tgmath.h> // fma of floats must be a float's

// kernels count with int, as the devices' languages do
#pragma GCC diagnostic ignored "-Wsign-conversion"
// and take all that kernels of their kind take
#pragma GCC diagnostic ignored "-Wunused-parameter"

#define KERNEL(items, name, ...) static void name(const int GROUP, __VA_ARGS__)
#define GLOBAL
#define SHARED
#define GROUP_MEMORY
#ifndef CONSTANT
#define CONSTANT static const
#endif
#define INLINED static inline
#define UNROLLED
#define ROLLED
#define ITEMS(item, count) for (int item = 0; item < (count); item++)
#define SYNC (void)0
#define FORGET_KEPT (void)0
#define COUNT_UP(counter) __atomic_fetch_add(counter, 1, __ATOMIC_RELAXED)
#define DEVICE_FMA fma
#define DEVICE_SQRT sqrt
#define uchar unsigned char
INLINED unsigned device_bits(float x) {
  union {
    float real;
    unsigned bits;
  } word = {.real = x};
  return word.bits;
}
INLINED float device_float(unsigned bits) {
  union {
    unsigned bits;
    float real;
  } word = {.bits = bits};
  return word.real;
}
#define DEVICE_BITS device_bits
#define DEVICE_FLOAT device_float
