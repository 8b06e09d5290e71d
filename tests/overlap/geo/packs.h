// SPDX-License-Identifier: GPL-3.0-or-later
// The ways into and out of packs that only tests go (overlap/geo/features/pack.h has the others).
#ifndef TETLAP_TESTS_OVERLAP_GEO_PACKS_H
#define TETLAP_TESTS_OVERLAP_GEO_PACKS_H

#include "overlap/geo/features/pack.h"

static inline void packs_take_matrix(const GeoSymmetric *pack, int lane, GeoMatrix *matrix) {
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j <= i; j++) matrix->row[i][j] = matrix->row[j][i] = pack->at[geo_entry(i, j)][lane];
}

// Numbers (count) of one lane.
static inline void packs_put_numbers(const double *numbers, int count, int lane, GeoPack *pack) {
  for (int k = 0; k < count; k++) pack[k][lane] = numbers[k];
}

#endif
