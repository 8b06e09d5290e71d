// SPDX-License-Identifier: Apache-2.0
#include "net/work.h"

#include "net/kernel/chunk.h"
#include "net/memory.h"

NetWorkDef net_work_default(void) {
  return (NetWorkDef){.thread_count = 1, .kernel = net_kernel_best()};
}

static NetStatus check(const NetWorkDef *def) {
  if (def->thread_count < 1 || def->thread_count > 1024)
    return net_status_fail(NET_BAD_ARGUMENT, "%d threads; 1 to 1024 are possible", def->thread_count);
  if (def->tangent_count < 0 || def->tangent_count > 1024)
    return net_status_fail(NET_BAD_ARGUMENT, "%d tangents a sample; 0 to 1024 are possible",
                           def->tangent_count);
  if (def->batch < 0) return net_status_fail(NET_BAD_ARGUMENT, "a batch of %d samples", def->batch);
  if (def->kernel >= NET_KERNEL_COUNT || !net_kernel_is_available(def->kernel))
    return net_status_fail(NET_BAD_ARGUMENT, "kernel %s: this processor cannot run it",
                           def->kernel < NET_KERNEL_COUNT ? net_kernel_name(def->kernel) : "?");
  return NET_OK;
}

#include "net/real_f32.h"

#include "net/work.inc"

#include "net/real_f64.h"

#include "net/work.inc"
