// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_bundle.h"

#include "base/cpu.h"

static const ContactGeoBundleKernel *const kernels[] = {
    &contact_geo_bundle_kernel_portable,
#if defined(__x86_64__)
    &contact_geo_bundle_kernel_avx2,
    &contact_geo_bundle_kernel_avx512,
#endif
};

const ContactGeoBundleKernel *const *contact_geo_bundle_kernels(int *count) {
  *count = 1 + cpu_has_avx2() + (cpu_has_avx2() && cpu_has_avx512());
  return kernels;
}

const ContactGeoBundleKernel *contact_geo_bundle_kernel(void) {
  int count;
  contact_geo_bundle_kernels(&count);
  return kernels[count - 1];
}
