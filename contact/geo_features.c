// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_features.h"

#include <stddef.h>

#include "base/cpu.h"

static const ContactGeoFeatureSet sets[] = {
    {.name = "pairs", .count = 36, .power_count = 4},
    {.name = "wedges",
     .count = 70,
     .power_count = 4,
     .link_count = 4,
     .links = {{1, 1}, {2, 0}, {1, 2}, {2, 1}}},
    {.name = "squares",
     .count = 100,
     .power_count = 4,
     .link_count = 4,
     .links = {{1, 1}, {2, 0}, {1, 2}, {2, 1}},
     .has_squares = true},
};

const ContactGeoFeatureSet *contact_geo_feature_set(int count) {
  for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
    if (sets[s].count == count) return &sets[s];
  return NULL;
}

// With AVX2, gcc 12 makes slower code of packs that are two registers wide than with four of SSE2: no kernel
// of its own.
static const ContactGeoKernel *const kernels[] = {
    &contact_geo_kernel_portable,
#if defined(__x86_64__)
    &contact_geo_kernel_avx512,
#endif
};

const ContactGeoKernel *const *contact_geo_kernels(int *count) {
  *count = 1 + cpu_has_avx512();
  return kernels;
}

const ContactGeoKernel *contact_geo_kernel(void) {
  int count;
  contact_geo_kernels(&count);
  return kernels[count - 1];
}
