// SPDX-License-Identifier: GPL-3.0-or-later
// Labelled pairs as arrays, one after another in memory.
#ifndef TETLAP_DATAGEN_PAIRS_H
#define TETLAP_DATAGEN_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

// Lengths are in edges of the unit cube. Arrays are owned by their creator; functions that fill or write some
// of them say what NULL means to them.
typedef struct DatagenPairs {
  double *coordinates; // vertices                                              (n, 2, 4, 3)
  uint8_t *status;     // 1: the closed tetrahedra have a point in common       (n)
  uint8_t *kind;       // DatagenKind                                           (n)
  double *volume;      // V; exactly 0 where they have no interior in common    (n)
  double *gradient;    // dV/dx                                                 (n, 2, 4, 3)
  double *centroid;    // x̄ of what they share; (0, 0, 0) where V is 0           (n, 3)
} DatagenPairs;

// Arrays for `count` pairs, zeroed. STATUS_MEMORY: nothing is left behind.
Status datagen_pairs_create(DatagenPairs *pairs, size_t count, bool has_gradient);
void datagen_pairs_destroy(DatagenPairs *pairs);

#endif
