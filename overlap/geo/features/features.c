// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/features/features.h"

#include <stddef.h>

#include "base/machine/cpu.h"

#define LINKS .link_count = 4, .links = {{1, 1}, {2, 0}, {1, 2}, {2, 1}}

static const OverlapGeoFeatureSet sets[] = {
    {.name = "pairs", .count = 36, .power_count = 4},
    {.name = "high pairs", .count = 56, .power_count = 6},
    {.name = "wedges", .count = 70, .power_count = 4, LINKS},
    {.name = "squares", .count = 100, .power_count = 4, LINKS, .has_squares = true},
    {.name = "high squares", .count = 120, .power_count = 6, LINKS, .has_squares = true},
};

const OverlapGeoFeatureSet *overlap_geo_features_set(int count) {
  for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
    if (sets[s].count == count) return &sets[s];
  return NULL;
}

int overlap_geo_features_plane_count(const OverlapGeoFeatureSet *set) {
  int count = OVERLAP_GEO_PLANE_DEGREE;
  for (int n = 1; n <= OVERLAP_GEO_PLANE_POWER; n++)
    for (int b = n <= 2; b < OVERLAP_GEO_MIXED; b++)
      for (int a = n == 1; a < OVERLAP_GEO_MIXED && a + b <= OVERLAP_GEO_PLANE_DEGREE; a++) count++;
  for (int e = 0; e < set->link_count; e++)
    count += 2 * OVERLAP_GEO_WEDGE_POWER - 1 - (set->links[e].power == 1);
  return count;
}

// With AVX2, gcc 12 makes slower code of packs that are two registers wide than with four of SSE2: no kernel
// of its own.
static const OverlapGeoKernel *const kernels[] = {
    &overlap_geo_features_kernel_portable,
#if defined(__x86_64__)
    &overlap_geo_features_kernel_avx512,
#endif
};

const OverlapGeoKernel *const *overlap_geo_features_kernels(int *count) {
  *count = 1 + cpu_has_avx512();
  return kernels;
}

const OverlapGeoKernel *overlap_geo_features_kernel(void) {
  int count;
  overlap_geo_features_kernels(&count);
  return kernels[count - 1];
}
