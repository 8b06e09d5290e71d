// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/bundle/bundle.h"

#include "base/machine/cpu.h"

static const OverlapGeoBundleKernel *const kernels[] = {
    &overlap_geo_bundle_kernel_portable,
#if defined(__x86_64__)
    &overlap_geo_bundle_kernel_avx2,
    &overlap_geo_bundle_kernel_avx512,
#endif
};

const OverlapGeoBundleKernel *const *overlap_geo_bundle_kernels(int *count) {
  *count = 1 + cpu_has_avx2() + (cpu_has_avx2() && cpu_has_avx512());
  return kernels;
}

const OverlapGeoBundleKernel *overlap_geo_bundle_kernel(void) {
  int count;
  overlap_geo_bundle_kernels(&count);
  return kernels[count - 1];
}
