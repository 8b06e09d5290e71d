// SPDX-License-Identifier: Apache-2.0
// The kernel for every processor: products by OpenBLAS, of which this is the only file that knows.
#include "net/kernel/kernel.h"

#include <cblas.h>
#include <stdint.h>
#include <string.h>

// bf16 rests on the fastest kernel where it is emulated.
static bool uses_blas(NetKernelKind kind) {
  return kind == NET_KERNEL_BLAS || (kind == NET_KERNEL_BF16 && net_kernel_best() == NET_KERNEL_BLAS);
}

int net_kernel_enter(NetKernelKind kind) {
  if (!uses_blas(kind)) return 0;
  int had = openblas_get_num_threads();
  openblas_set_num_threads(1);
  return had;
}

void net_kernel_leave(NetKernelKind kind, int had) {
  if (uses_blas(kind)) openblas_set_num_threads(had);
}

#include "net/real_f32.h"
#define KERNEL_NAME(name) name##_blas_f32
#define KERNEL_GEMM cblas_sgemm

#include "net/kernel/blas.inc"

#include "net/real_f64.h"
#undef KERNEL_NAME
#undef KERNEL_GEMM
#define KERNEL_NAME(name) name##_blas_f64
#define KERNEL_GEMM cblas_dgemm

#include "net/kernel/blas.inc"
