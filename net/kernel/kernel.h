// SPDX-License-Identifier: Apache-2.0
// The arithmetic of a pass on matrices whose rows are features and whose columns are samples: products,
// activations, pools, with their derivatives. Three implementations behind one table: `blas` (OpenBLAS, every
// processor), `avx2` and `avx512` (kernels of ours, for the small inner sizes that a BLAS packs at a loss).
// They differ by rounding only; which one runs is chosen once from what the processor has, and a test holds
// them together. A fourth, `bf16`, is another arithmetic: the factors of products are rounded to bf16 and
// summed in float. It is twice as fast where the processor has the instruction, and emulated elsewhere.
//
// Column counts are multiples of NET_COLUMN_UNIT; matrices begin on a cache line.
#ifndef NET_KERNEL_H
#define NET_KERNEL_H

#include <stdbool.h>
#include <stddef.h>

#include "net/model/shape.h"

enum { NET_COLUMN_UNIT = 16 };

typedef enum NetKernelKind {
  NET_KERNEL_BLAS,
  NET_KERNEL_AVX2,
  NET_KERNEL_AVX512,
  NET_KERNEL_BF16, // float alone, less exact: chosen by name only, there on every processor
  NET_KERNEL_COUNT
} NetKernelKind;

// Whether this processor can run it.
bool net_kernel_is_available(NetKernelKind kind);

// The fastest that is available and rounds to the full precision.
NetKernelKind net_kernel_best(void);

const char *net_kernel_name(NetKernelKind kind);

// OpenBLAS computes in one thread between these two, for the threads are ours; the number it had is handed
// back and restored. They change OpenBLAS's setting of the whole process and do nothing for kernels of ours.
int net_kernel_enter(NetKernelKind kind);
void net_kernel_leave(NetKernelKind kind, int had);

#include "net/real_f32.h"

#include "net/kernel/template.h"

#include "net/real_f64.h"

#include "net/kernel/template.h"

#endif
