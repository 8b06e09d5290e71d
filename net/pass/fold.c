// SPDX-License-Identifier: Apache-2.0
#include "net/pass/fold.h"

#include <string.h>

#include "net/memory.h"
#include "net/pass/pass.h"

enum { COORDINATES = 12 };

// The slot whose two parts are the tetrahedra's features: what the pool over tetrahedra reads.
static int find_features(const NetPlan *plan) {
  for (int k = plan->step_count - 1; k >= 0; k--)
    if (plan->steps[k].kind == NET_STEP_POOL) return plan->steps[k].input;
  return -1;
}

#include "net/real_f32.h"

#include "net/pass/fold.inc"

#include "net/real_f64.h"

#include "net/pass/fold.inc"
