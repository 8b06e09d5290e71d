// SPDX-License-Identifier: Apache-2.0
#include "net/training/adam.h"

#include <math.h>

#include "net/memory.h"

NetAdamDef net_adam_default(void) {
  return (NetAdamDef){.beta1 = 0.9, .beta2 = 0.999, .epsilon = 1e-8, .weight_decay = 0.01};
}

#include "net/real_f32.h"

#include "net/training/adam.inc"

#include "net/real_f64.h"

#include "net/training/adam.inc"
