// SPDX-License-Identifier: Apache-2.0
// GEO_PACK numbers side by side, computed with as one (a vector type of gcc and clang: on a processor without
// such registers the compiler splits it). The lanes of a pack are different pairs, or different directions of
// one. Eight, unless the including file says otherwise first; packs of another size stay within that file.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_PACK_H
#define TETLAP_OVERLAP_GEO_FEATURES_PACK_H

#include <stdbool.h>

#include "overlap/geo/lanes.h"

#ifndef GEO_PACK
#define GEO_PACK 8
#endif

typedef double GeoPack __attribute__((vector_size(GEO_PACK * sizeof(double))));

#define GEO_PACK_ZERO ((GeoPack){0})
#define GEO_ROLLED // a loop that must not be unrolled on a device, which has too few registers

#include "overlap/geo/features/invariants.h"

// One lane of the whole matrix.
static inline void geo_pack_matrix(const GeoMatrix *matrix, int lane, GeoSymmetric *pack) {
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j <= i; j++) pack->at[geo_entry(i, j)][lane] = matrix->row[i][j];
}

// Numbers (count) of one lane.
static inline void geo_unpack_numbers(const GeoPack *pack, int count, int lane, double *numbers) {
  for (int k = 0; k < count; k++) numbers[k] = pack[k][lane];
}

#endif
