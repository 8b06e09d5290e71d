// SPDX-License-Identifier: Apache-2.0
#include "device/network/pack.h"

#include "device/kernels/language_host.h"

#include "device/kernels/tpn/bf16.inc"

#include "device/kernels/tpn/mma.inc"

static int tiles_of(int count, int size) {
  return (count + size - 1) / size;
}

size_t device_pack_size(int rows, int inner) {
  return (size_t)MMA_TILE * (size_t)tiles_of(rows, MMA_ROWS) * (size_t)tiles_of(inner, MMA_INNER);
}

void device_pack_matrix(int rows, int inner, const float *at, int row_step, int inner_step, unsigned *words) {
  for (int i = 0; i < rows; i += MMA_ROWS)
    for (int l = 0; l < inner; l += MMA_INNER)
      for (int k = 0; k < MMA_TILE; k++) {
        const int lane = k / MMA_LEFT, row = i + mma_left_row(lane, k % MMA_LEFT);
        const int first = l + mma_left_inner(lane, k % MMA_LEFT);
        float two[2] = {0, 0};
        for (int h = 0; h < 2; h++)
          if (row < rows && first + h < inner) two[h] = at[row * row_step + (first + h) * inner_step];
        *words++ = bf16_pack(two[0], two[1]);
      }
}

float device_pack_round(float x) {
  return bf16_round(x);
}
