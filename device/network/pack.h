// SPDX-License-Identifier: Apache-2.0
// Matrices as the fragments that tensor cores multiply by from the left (kernels/tpn/mma.inc): tiles of 16 by 16,
// row by row, zeros beyond the matrix; of a tile four words for each of 32 lanes, bf16 two a word. Private to
// device/.
#ifndef TETLAP_DEVICE_NETWORK_PACK_H
#define TETLAP_DEVICE_NETWORK_PACK_H

#include <stddef.h>

size_t device_pack_size(int rows, int inner); // words

// Element (i, l) is at[i row_step + l inner_step].
void device_pack_matrix(int rows, int inner, const float *at, int row_step, int inner_step, unsigned *words);

// The nearest bf16, of two equally near the even one, as a float.
float device_pack_round(float x);

#endif
