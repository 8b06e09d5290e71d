// SPDX-License-Identifier: Apache-2.0
// NVIDIA's compiler as a library, NVRTC. It needs no GPU.
#ifndef TETLAP_DEVICE_BACKEND_CUDA_H
#define TETLAP_DEVICE_BACKEND_CUDA_H

#include <stdbool.h>
#include <stddef.h>

#include "device/device.h"

// Whether it is there; if not, why.
bool device_cuda_compiler(char reason[DEVICE_TEXT]);

// Machine code for a target such as "sm_90", the caller's (memory_free). `tells`: with ptxas' account of
// registers and spills in `*log` (the caller's, may be NULL). STATUS_DEVICE: no compiler, or it refuses.
Status device_cuda_compile(const DeviceProgram *program, const char *target, bool tells, char **code,
                           size_t *size, char **log);

#endif
