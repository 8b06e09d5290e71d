// SPDX-License-Identifier: Apache-2.0
#include "net/kernel/kernel.h"

#include "net/kernel/bf16.h"

static const NetKernel_f32 *bf16_kernel_f32(void) {
#if defined(__x86_64__)
  if (net_kernel_bf16_is_native()) return &net_kernel_bf16_native;
#endif
  return &net_kernel_bf16_emulated;
}

static const NetKernel_f64 *bf16_kernel_f64(void) {
  return NULL;
}

bool net_kernel_is_available(NetKernelKind kind) {
  switch (kind) {
  case NET_KERNEL_BLAS:
  case NET_KERNEL_BF16:
    return true;
#if defined(__x86_64__)
  case NET_KERNEL_AVX2:
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  case NET_KERNEL_AVX512:
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#endif
  default:
    return false;
  }
}

NetKernelKind net_kernel_best(void) {
  int kind = NET_KERNEL_AVX512;
  while (kind > 0 && !net_kernel_is_available((NetKernelKind)kind)) kind--;
  return (NetKernelKind)kind;
}

const char *net_kernel_name(NetKernelKind kind) {
  static const char *const names[NET_KERNEL_COUNT] = {"blas", "avx2", "avx512", "bf16"};
  return names[kind];
}

#include "net/real_f32.h"

#include "net/kernel/choice.inc"

#include "net/real_f64.h"

#include "net/kernel/choice.inc"
