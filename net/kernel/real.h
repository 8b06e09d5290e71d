// SPDX-License-Identifier: Apache-2.0
// The kernels that compute in the numbers they are given, by instruction set. Private to net/kernel: kernel.h
// offers them together with the one that rounds factors (bf16.h), which is built on them.
#ifndef NET_KERNEL_REAL_H
#define NET_KERNEL_REAL_H

#include "net/kernel/kernel.h"

// Whether the processor has it; false of NET_KERNEL_BF16.
bool net_kernel_real_is_available(NetKernelKind kind);
NetKernelKind net_kernel_real_best(void);

// NULL: not available.
const NetKernel_f32 *net_kernel_real_f32(NetKernelKind kind);
const NetKernel_f64 *net_kernel_real_f64(NetKernelKind kind);

#endif
