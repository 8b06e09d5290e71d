// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/pairs.h"

#include "base/memory.h"

Status datagen_pairs_create(DatagenPairs *pairs, size_t count, bool has_gradient) {
  *pairs = (DatagenPairs){.coordinates = memory_zeroed(count, 24 * sizeof(double)),
                          .status = memory_zeroed(count, 1),
                          .kind = memory_zeroed(count, 1),
                          .volume = memory_zeroed(count, sizeof(double)),
                          .gradient = has_gradient ? memory_zeroed(count, 24 * sizeof(double)) : NULL,
                          .centroid = memory_zeroed(count, 3 * sizeof(double))};
  if (pairs->coordinates && pairs->status && pairs->kind && pairs->volume && pairs->centroid &&
      (pairs->gradient || !has_gradient))
    return STATUS_OK;
  datagen_pairs_destroy(pairs);
  return status_no_memory("the pairs");
}

void datagen_pairs_destroy(DatagenPairs *pairs) {
  memory_free(pairs->coordinates);
  memory_free(pairs->status);
  memory_free(pairs->kind);
  memory_free(pairs->volume);
  memory_free(pairs->gradient);
  memory_free(pairs->centroid);
  *pairs = (DatagenPairs){0};
}
