// SPDX-License-Identifier: Apache-2.0
// The programs that devices compile: pieces of text that the build puts into the program, one after another,
// under what makes their words mean something in the language (kernels/language_*.inc).
//
// A kernel is written for one group of items, as phases of all of them:
//
//   GROUP_MEMORY float a[…];            OpenCL  __local     item = get_local_id(0)
//   ITEMS(i, COUNT) { … a[i] = … }      CUDA    __shared__  item = threadIdx.x
//   SYNC;                               host C  an array    ITEMS is a loop, SYNC is nothing
//   ITEMS(i, COUNT) { … }
//
// No contraction, IEEE division and root: what a kernel computes is the same to the bit everywhere.
#ifndef TETLAP_DEVICE_KERNELS_SOURCE_H
#define TETLAP_DEVICE_KERNELS_SOURCE_H

#include <stdint.h>

#include "base/status.h"

enum { DEVICE_MAX_PIECES = 20, DEVICE_MAX_KERNELS = 10 };

typedef enum DeviceLanguage { DEVICE_OPENCL_C, DEVICE_CUDA_CPP } DeviceLanguage;

typedef struct DeviceProgram {
  const char *name;
  const char *defines;                     // lines before the pieces
  const char *pieces[DEVICE_MAX_PIECES];   // texts
  const char *kernels[DEVICE_MAX_KERNELS]; // names
  int items;                               // of a group
} DeviceProgram;

extern const DeviceProgram device_program_clip, device_program_clip32, device_program_gather,
    device_program_poses, device_program_tpn, device_program_tpn_bf16, device_program_scalar,
    device_program_geo_small, device_program_geo, device_program_peak;

// The whole text, the caller's (memory_free). STATUS_MEMORY.
Status device_source_text(const DeviceProgram *program, DeviceLanguage language, char **text);

#endif
