// SPDX-License-Identifier: Apache-2.0
#include "net/pass.h"

#include <string.h>

int net_pass_chunk(int tangents) {
  int samples = NET_CHUNK_COLUMNS / (1 + tangents) / NET_COLUMN_UNIT * NET_COLUMN_UNIT;
  return samples > NET_COLUMN_UNIT ? samples : NET_COLUMN_UNIT;
}

int net_pass_chunk_count(int count, int tangents) {
  int chunk = net_pass_chunk(tangents);
  return count / chunk + (count % chunk != 0);
}

#include "net/real_f32.h"

#include "net/pass.inc"

#include "net/real_f64.h"

#include "net/pass.inc"
