// SPDX-License-Identifier: Apache-2.0
// The memory of evaluation, allocated once: no call that takes it allocates. It belongs to one caller at a
// time and serves any model of the same shape.
//
// Samples are computed in chunks: small enough that a chunk's matrices stay in the second-level cache, and
// cut independently of the number of threads. A gradient of the parameters is summed over chunks in a fixed
// number of lanes, then over lanes, both in their order; so every result is the same to the bit for any
// number of threads.
#ifndef NET_WORK_H
#define NET_WORK_H

#include "net/kernel/chunk.h"
#include "net/kernel/kernel.h"
#include "net/model/model.h"

enum { NET_LANES = 16 };

typedef struct NetWorkDef {
  int thread_count;  // ≥ 1
  int tangent_count; // largest number of tangents a sample, 0: none
  int batch;         // samples whose pass is kept for a gradient of the parameters, 0: no such gradient
  NetKernelKind kernel;
} NetWorkDef;

// One thread, no tangents, nothing kept, the fastest kernel.
NetWorkDef net_work_default(void);

#include "net/real_f32.h"

#include "net/work_template.h"

#include "net/real_f64.h"

#include "net/work_template.h"

#endif
