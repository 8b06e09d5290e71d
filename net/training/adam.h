// SPDX-License-Identifier: Apache-2.0
// AdamW: Adam with decoupled weight decay (Loshchilov and Hutter 2019, algorithm 2), as PyTorch has it, and
// the clipping of a gradient by its global norm.
#ifndef NET_ADAM_H
#define NET_ADAM_H

#include <stddef.h>
#include <stdint.h>

#include "net/status.h"

typedef struct NetAdamDef {
  double beta1, beta2; // decay of the first and the second moment
  double epsilon;      // added to the root of the second moment
  double weight_decay; // all parameters shrink by rate · weight_decay a step
} NetAdamDef;

NetAdamDef net_adam_default(void); // 0.9, 0.999, 1e-8, 0.01

#include "net/real_f32.h"

#include "net/training/adam_template.h"

#include "net/real_f64.h"

#include "net/training/adam_template.h"

#endif
