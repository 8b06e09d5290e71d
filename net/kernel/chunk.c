// SPDX-License-Identifier: Apache-2.0
#include "net/kernel/chunk.h"

#include "net/kernel/kernel.h"

int net_chunk_size(int tangents) {
  int samples = NET_CHUNK_COLUMNS / (1 + tangents) / NET_COLUMN_UNIT * NET_COLUMN_UNIT;
  return samples > NET_COLUMN_UNIT ? samples : NET_COLUMN_UNIT;
}

int net_chunk_count(int count, int tangents) {
  int chunk = net_chunk_size(tangents);
  return count / chunk + (count % chunk != 0);
}
