// SPDX-License-Identifier: Apache-2.0
#include "net/model/model.h"

#include "net/memory.h"
#include "net/model/random.h"

#include "net/real_f32.h"

#include "net/model/model.inc"

#include "net/real_f64.h"

#include "net/model/model.inc"

void net_model_widen(const NetModel_f32 *from, NetModel_f64 *to) {
  for (size_t k = 0; k < from->plan->parameter_count; k++) to->parameters[k] = from->parameters[k];
}
