// SPDX-License-Identifier: Apache-2.0
#include "net/kernel/real.h"

bool net_kernel_real_is_available(NetKernelKind kind) {
  switch (kind) {
  case NET_KERNEL_BLAS:
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

NetKernelKind net_kernel_real_best(void) {
  int kind = NET_KERNEL_AVX512;
  while (kind > 0 && !net_kernel_real_is_available((NetKernelKind)kind)) kind--;
  return (NetKernelKind)kind;
}

#include "net/real_f32.h"

#include "net/kernel/real.inc"

#include "net/real_f64.h"

#include "net/kernel/real.inc"
