// SPDX-License-Identifier: Apache-2.0
#include "net/kernel/kernel.h"

#include "net/kernel/bf16.h"
#include "net/kernel/real.h"

bool net_kernel_is_available(NetKernelKind kind) {
  return kind == NET_KERNEL_BF16 || net_kernel_real_is_available(kind);
}

NetKernelKind net_kernel_best(void) {
  return net_kernel_real_best();
}

const char *net_kernel_name(NetKernelKind kind) {
  static const char *const names[NET_KERNEL_COUNT] = {"blas", "avx2", "avx512", "bf16"};
  return names[kind];
}

const NetKernel_f32 *net_kernel_f32(NetKernelKind kind) {
  if (kind != NET_KERNEL_BF16) return net_kernel_real_f32(kind);
#if defined(__x86_64__)
  if (net_kernel_bf16_is_native()) return &net_kernel_bf16_native;
#endif
  return &net_kernel_bf16_emulated;
}

const NetKernel_f64 *net_kernel_f64(NetKernelKind kind) {
  return net_kernel_real_f64(kind);
}
