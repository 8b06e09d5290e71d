// SPDX-License-Identifier: Apache-2.0
// The form for every processor.
#include "net/kernel/bf16.h"

#include <stdint.h>

#include "net/kernel/real.h"

enum { COLUMNS = 4 * NET_COLUMN_UNIT };

bool net_kernel_bf16_is_native(void) {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512bf16") && __builtin_cpu_supports("avx512f") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw");
#else
  return false;
#endif
}

float net_kernel_bf16_round(float x) {
  union {
    float real;
    uint32_t bits;
  } word = {.real = x};
  if (!(x == x)) return x;
  word.bits = (word.bits + 0x7fff + (word.bits >> 16 & 1)) & 0xffff0000u;
  return word.real;
}

static const NetKernel_f32 *floats(void) {
  return net_kernel_real_f32(net_kernel_real_best());
}

// One block, a few columns at a time.
static void multiply_block(const NetProduct_f32 *p) {
  _Alignas(64) float a[NET_BF16_ROWS * NET_BF16_INNER], b[NET_BF16_INNER * COLUMNS];
  for (int i = 0; i < p->m; i++)
    for (int l = 0; l < p->k; l++)
      a[i * p->k + l] = net_kernel_bf16_round(p->a[i * p->a_row + l * p->a_column]);
  for (int j = 0; j < p->n; j += COLUMNS) {
    NetProduct_f32 part = *p;
    part.n = p->n - j < COLUMNS ? p->n - j : COLUMNS;
    for (int l = 0; l < p->k; l++)
      for (int q = 0; q < part.n; q++) b[l * COLUMNS + q] = net_kernel_bf16_round(p->b[l * p->b_row + j + q]);
    part.a = a, part.a_row = p->k, part.a_column = 1;
    part.b = b, part.b_row = COLUMNS;
    part.c += j;
    if (part.base) part.base += j;
    floats()->product(&part);
  }
}

#include "net/real_f32.h"
#define KERNEL_NAME(name) name##_emulated_bf16

#include "net/kernel/elementwise.inc"

static void product_emulated_bf16(const NetProduct_f32 *p) {
  if (p->is_raw) {
    floats()->product(p);
    return;
  }
  for (int i = 0; i < p->m; i += NET_BF16_ROWS)
    for (int l = 0; l < p->k; l += NET_BF16_INNER) {
      NetProduct_f32 block = net_kernel_bf16_block(p, i, l);
      multiply_block(&block);
    }
}

static void outer_emulated_bf16(int m, int k, int n, const float *a, ptrdiff_t a_row, const float *b,
                                ptrdiff_t b_row, float *c) {
  floats()->outer(m, k, n, a, a_row, b, b_row, c);
}

const NetKernel_f32 net_kernel_bf16_emulated = KERNEL_TABLE;
