// SPDX-License-Identifier: Apache-2.0
// A network: its plan and its parameters, in float or double. Constant while it is evaluated, from any number
// of threads.
#ifndef NET_MODEL_H
#define NET_MODEL_H

#include <stdint.h>

#include "net/model/plan.h"

#include "net/real_f32.h"

#include "net/model/model_template.h"

#include "net/real_f64.h"

#include "net/model/model_template.h"

// The same parameters in the other precision; the shapes must be equal.
void net_model_widen(const NetModel_f32 *from, NetModel_f64 *to);

#endif
