// SPDX-License-Identifier: Apache-2.0
// Products whose factors are rounded to bf16 (8 bits of precision, the exponent of a float) and summed in
// float. The rest of a pass stays float; so do products with the network's own input, which are few and carry
// the geometry (NetProduct.is_raw). Private to net/: kernel.h offers it as NET_KERNEL_BF16.
//
//   native    VDPBF16PS (AVX512_BF16), two multiplications a lane and instruction
//   emulated  the fastest float kernel on rounded factors; the same but for the order of the sum
//
// Two factors of 8 bits have a product of 16: exact in float, so only sums round.
#ifndef NET_KERNEL_BF16_H
#define NET_KERNEL_BF16_H

#include "net/kernel/kernel.h"

enum { NET_BF16_ROWS = 64, NET_BF16_INNER = 128 }; // of a block of A that is rounded at once

extern const NetKernel_f32 net_kernel_bf16_emulated;
#if defined(__x86_64__)
extern const NetKernel_f32 net_kernel_bf16_native; // where net_kernel_bf16_is_native
#endif

// Whether this processor has the instructions.
bool net_kernel_bf16_is_native(void);

// The nearest bf16, of two equally near the even one, as a float.
float net_kernel_bf16_round(float x);

// The block of rows i … and inner indices l … of a product, so that blocks can follow each other: the first
// in l brings base and bias, the last the rectifier.
static inline NetProduct_f32 net_kernel_bf16_block(const NetProduct_f32 *p, int i, int l) {
  NetProduct_f32 block = *p;
  block.m = p->m - i < NET_BF16_ROWS ? p->m - i : NET_BF16_ROWS;
  block.k = p->k - l < NET_BF16_INNER ? p->k - l : NET_BF16_INNER;
  block.a += i * p->a_row + l * p->a_column;
  block.b += l * p->b_row;
  block.c += i * p->c_row;
  block.base = l > 0 ? block.c : p->base ? p->base + i * p->base_row : NULL;
  block.base_row = l > 0 ? p->c_row : p->base_row;
  block.bias = l > 0 || !p->bias ? NULL : p->bias + i;
  block.has_relu = p->has_relu && l + block.k == p->k;
  return block;
}

#endif
