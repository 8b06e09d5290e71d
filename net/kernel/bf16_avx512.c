// SPDX-License-Identifier: Apache-2.0
// Products with VDPBF16PS. It multiplies pairs: a lane holds (b[l, j], b[l + 1, j]) of column j, and a pair
// (a[i, l], a[i, l + 1]) is broadcast. Factors are rounded and paired as a block is begun: A's once for all
// columns, B's panel of two vectors of columns once for all rows of the block.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(                                                                                \
    __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx512bf16,avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,avx512bf16,avx2,fma,prefer-vector-width=512")
#endif
#include <immintrin.h>
#include <stdint.h>

#include "net/kernel/bf16.h"

enum { WIDTH = 16, PAIRS = NET_BF16_INNER / 2, TILE = 8 };

#define KERNEL_ROWS TILE
#define KERNEL_OUTER 4
#define KERNEL_PRODUCT float_product_bf16

#include "net/real_f32.h"
#define KERNEL_NAME(name) name##_bf16
#define KERNEL_VECTOR __m512
#define KERNEL_WIDTH 16

static inline __m512 vector_all_bf16(float x) {
  return _mm512_set1_ps(x);
}
static inline __m512 vector_multiply_add_bf16(__m512 a, __m512 b, __m512 c) {
  return _mm512_fmadd_ps(a, b, c);
}
static inline __m512 vector_rectify_bf16(__m512 a) {
  return _mm512_max_ps(a, _mm512_setzero_ps());
}
static inline float vector_sum_bf16(__m512 a) {
  return _mm512_reduce_add_ps(a);
}

#include "net/kernel/elementwise.inc"
#include "net/kernel/tiles.inc"

// A's rounded block: the pair l, l + 1 of row i is word[i row + l/2 pair].
typedef struct Left {
  _Alignas(64) uint32_t word[NET_BF16_ROWS * PAIRS];
  ptrdiff_t row, pair;
} Left;

// B's rounded panel: the pair of row l/2 and column j is word[l/2][j].
typedef struct Right {
  _Alignas(64) uint32_t word[PAIRS][2 * WIDTH];
} Right;

KERNEL_INLINE __m512i round_both(__m512 low, __m512 high) {
  return (__m512i)_mm512_cvtne2ps_pbh(high, low);
}

// (low[0], high[0], low[1], …), rounded
KERNEL_INLINE __m512i round_pairs(__m512 low, __m512 high) {
  const __m512i zip = _mm512_set_epi16(31, 15, 30, 14, 29, 13, 28, 12, 27, 11, 26, 10, 25, 9, 24, 8, 23, 7,
                                       22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
  return _mm512_permutexvar_epi16(zip, round_both(low, high));
}

KERNEL_INLINE __mmask16 first_of(int count) {
  return count >= WIDTH ? (__mmask16)0xffff : count <= 0 ? 0 : (__mmask16)((1u << count) - 1);
}

// Rows lie in memory: pairs are neighbours there.
static void pack_rows(const NetProduct_f32 *p, Left *left) {
  left->row = PAIRS, left->pair = 1;
  for (int i = 0; i < p->m; i++)
    for (int l = 0; l < p->k; l += 2 * WIDTH) {
      const float *from = p->a + i * p->a_row + l;
      __m512 low = _mm512_maskz_loadu_ps(first_of(p->k - l), from);
      __m512 high = _mm512_maskz_loadu_ps(first_of(p->k - l - WIDTH), from + WIDTH);
      _mm512_store_si512(left->word + i * PAIRS + l / 2, round_both(low, high));
    }
}

// Columns lie in memory, as in a transposed A.
static void pack_columns(const NetProduct_f32 *p, Left *left) {
  left->row = 1, left->pair = NET_BF16_ROWS;
  for (int l = 0; l < p->k; l += 2)
    for (int i = 0; i < p->m; i += WIDTH) {
      const float *from = p->a + i + l * p->a_column;
      __mmask16 rows = first_of(p->m - i);
      __m512 low = _mm512_maskz_loadu_ps(rows, from);
      __m512 high = l + 1 < p->k ? _mm512_maskz_loadu_ps(rows, from + p->a_column) : _mm512_setzero_ps();
      _mm512_store_si512(left->word + l / 2 * NET_BF16_ROWS + i, round_pairs(low, high));
    }
}

KERNEL_INLINE void pack_panel(const NetProduct_f32 *p, int j, const int vectors, Right *right) {
  for (int l = 0; l < p->k; l += 2) {
    const float *from = p->b + l * p->b_row + j;
    for (int v = 0; v < vectors; v++) {
      __m512 low = _mm512_load_ps(from + v * WIDTH);
      __m512 high = l + 1 < p->k ? _mm512_load_ps(from + p->b_row + v * WIDTH) : _mm512_setzero_ps();
      _mm512_store_si512(right->word[l / 2] + v * WIDTH, round_pairs(low, high));
    }
  }
}

KERNEL_INLINE void multiply_tile(const NetProduct_f32 *p, const Left *left, const Right *right, int i, int j,
                                 const int rows, const int vectors) {
  __m512 sum[TILE][2];
#pragma GCC unroll 8
  for (int r = 0; r < rows; r++) {
    __m512 first = _mm512_set1_ps(p->bias ? p->bias[i + r] : 0);
#pragma GCC unroll 2
    for (int v = 0; v < vectors; v++) {
      sum[r][v] = first;
      if (p->base) sum[r][v] += _mm512_load_ps(p->base + (i + r) * p->base_row + j + v * WIDTH);
    }
  }
  const uint32_t *a = left->word + i * left->row;
  const ptrdiff_t row = left->row, pair = left->pair;
  const int pairs = (p->k + 1) / 2;
  for (int l = 0; l < pairs; l++, a += pair) {
    __m512bh column[2];
#pragma GCC unroll 2
    for (int v = 0; v < vectors; v++) column[v] = (__m512bh)_mm512_load_si512(right->word[l] + v * WIDTH);
#pragma GCC unroll 8
    for (int r = 0; r < rows; r++) {
      __m512bh weight = (__m512bh)_mm512_set1_epi32((int)a[r * row]);
#pragma GCC unroll 2
      for (int v = 0; v < vectors; v++) sum[r][v] = _mm512_dpbf16_ps(sum[r][v], weight, column[v]);
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < rows; r++)
#pragma GCC unroll 2
    for (int v = 0; v < vectors; v++) {
      if (p->has_relu) sum[r][v] = vector_rectify_bf16(sum[r][v]);
      _mm512_store_ps(p->c + (i + r) * p->c_row + j + v * WIDTH, sum[r][v]);
    }
}

KERNEL_INLINE void multiply_panel(const NetProduct_f32 *p, const Left *left, int j, const int vectors) {
  Right right;
  int i = 0;
  pack_panel(p, j, vectors, &right);
  for (; i + TILE <= p->m; i += TILE) multiply_tile(p, left, &right, i, j, TILE, vectors);
  for (; i + 4 <= p->m; i += 4) multiply_tile(p, left, &right, i, j, 4, vectors);
  for (; i + 2 <= p->m; i += 2) multiply_tile(p, left, &right, i, j, 2, vectors);
  for (; i < p->m; i++) multiply_tile(p, left, &right, i, j, 1, vectors);
}

static void multiply_block(const NetProduct_f32 *p) {
  Left left;
  if (p->a_column == 1)
    pack_rows(p, &left);
  else
    pack_columns(p, &left);
  int j = 0;
  for (; j + 2 * WIDTH <= p->n; j += 2 * WIDTH) multiply_panel(p, &left, j, 2);
  for (; j < p->n; j += WIDTH) multiply_panel(p, &left, j, 1);
}

static void product_bf16(const NetProduct_f32 *p) {
  if (p->is_raw) {
    float_product_bf16(p);
    return;
  }
  for (int i = 0; i < p->m; i += NET_BF16_ROWS)
    for (int l = 0; l < p->k; l += NET_BF16_INNER) {
      NetProduct_f32 block = net_kernel_bf16_block(p, i, l);
      multiply_block(&block);
    }
}

const NetKernel_f32 net_kernel_bf16_native = KERNEL_TABLE;
#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
typedef int net_kernel_bf16_avx512_is_not_empty;
