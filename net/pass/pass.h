// SPDX-License-Identifier: Apache-2.0
// One chunk of samples through the steps of a plan, forward and backward. Private to net/: forward.h,
// gradient.h and tangent.h drive it over all chunks.
#ifndef NET_PASS_H
#define NET_PASS_H

#include "net/kernel/kernel.h"
#include "net/model/plan.h"
#include "net/work.h"

#include "net/real_f32.h"

#include "net/pass/pass_template.h"

#include "net/real_f64.h"

#include "net/pass/pass_template.h"

#endif
