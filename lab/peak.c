// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/peak.h"

#include <math.h>

#include "base/machine/clock.h"
#include "base/machine/cpu.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

enum { CHAINS = 12, ROUNDS = 30, LOOPS = 100000 };

// Twelve chains keep two units busy whose results come after four cycles; each value goes to a fixed point,
// so nothing overflows or gets denormal. Every kernel returns what it computed, lest it be left out, and how
// many numbers a vector has.
typedef struct Work {
  double value;
  int lanes;
} Work;

// What a chain multiplies by and adds; not known to the compiler.
static volatile double factor = 0.5, offset = 1;

#if defined(__x86_64__)
__attribute__((target("avx512f"))) static Work work_wide_double(void) {
  __m512d a[CHAINS], f = _mm512_set1_pd(factor), o = _mm512_set1_pd(offset);
  for (int c = 0; c < CHAINS; c++) a[c] = _mm512_set1_pd(c);
  for (int i = 0; i < LOOPS; i++)
#pragma GCC unroll 12
    for (int c = 0; c < CHAINS; c++) a[c] = _mm512_fmadd_pd(a[c], f, o);
  for (int c = 1; c < CHAINS; c++) a[0] = _mm512_add_pd(a[0], a[c]);
  return (Work){_mm512_reduce_add_pd(a[0]), 8};
}

__attribute__((target("avx512f"))) static Work work_wide_float(void) {
  __m512 a[CHAINS], f = _mm512_set1_ps((float)factor), o = _mm512_set1_ps((float)offset);
  for (int c = 0; c < CHAINS; c++) a[c] = _mm512_set1_ps((float)c);
  for (int i = 0; i < LOOPS; i++)
#pragma GCC unroll 12
    for (int c = 0; c < CHAINS; c++) a[c] = _mm512_fmadd_ps(a[c], f, o);
  for (int c = 1; c < CHAINS; c++) a[0] = _mm512_add_ps(a[0], a[c]);
  return (Work){(double)_mm512_reduce_add_ps(a[0]), 16};
}

__attribute__((target("avx2,fma"))) static Work work_double(void) {
  __m256d a[CHAINS], f = _mm256_set1_pd(factor), o = _mm256_set1_pd(offset);
  for (int c = 0; c < CHAINS; c++) a[c] = _mm256_set1_pd(c);
  for (int i = 0; i < LOOPS; i++)
#pragma GCC unroll 12
    for (int c = 0; c < CHAINS; c++) a[c] = _mm256_fmadd_pd(a[c], f, o);
  for (int c = 1; c < CHAINS; c++) a[0] = _mm256_add_pd(a[0], a[c]);
  return (Work){_mm256_cvtsd_f64(a[0]), 4};
}

__attribute__((target("avx2,fma"))) static Work work_float(void) {
  __m256 a[CHAINS], f = _mm256_set1_ps((float)factor), o = _mm256_set1_ps((float)offset);
  for (int c = 0; c < CHAINS; c++) a[c] = _mm256_set1_ps((float)c);
  for (int i = 0; i < LOOPS; i++)
#pragma GCC unroll 12
    for (int c = 0; c < CHAINS; c++) a[c] = _mm256_fmadd_ps(a[c], f, o);
  for (int c = 1; c < CHAINS; c++) a[0] = _mm256_add_ps(a[0], a[c]);
  return (Work){(double)_mm256_cvtss_f32(a[0]), 8};
}
#endif

// Two numbers at a time, which every 64-bit processor of today can.
static Work work_portable(void) {
  double a[CHAINS][2], f = factor, o = offset, sum = 0;
  for (int c = 0; c < CHAINS; c++) a[c][0] = a[c][1] = c;
  for (int i = 0; i < LOOPS; i++)
    for (int c = 0; c < CHAINS; c++) a[c][0] = a[c][0] * f + o, a[c][1] = a[c][1] * f + o;
  for (int c = 0; c < CHAINS; c++) sum += a[c][0] + a[c][1];
  return (Work){sum, 2};
}

static Work work(bool is_float) {
#if defined(__x86_64__)
  if (cpu_has_avx512()) return is_float ? work_wide_float() : work_wide_double();
  if (cpu_has_avx2()) return is_float ? work_float() : work_double();
#endif
  (void)is_float;
  return work_portable();
}

double lab_peak_measure(bool is_float) {
  static volatile double kept;
  double best = 0;
  for (int round = 0; round < ROUNDS; round++) {
    double began = clock_wall_s();
    Work done = work(is_float);
    double seconds = clock_wall_s() - began;
    kept = kept + done.value;
    best = fmax(best, 2.0 * LOOPS * CHAINS * done.lanes / seconds);
  }
  return best;
}
