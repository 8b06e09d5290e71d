// SPDX-License-Identifier: Apache-2.0
// Outputs of any number of samples, and their derivatives with respect to the input. Only the outputs that
// work->outputs names are computed, with what they need; the others are 0.
#ifndef NET_FORWARD_H
#define NET_FORWARD_H

#include "net/work.h"

#include "net/real_f32.h"

#include "net/pass/forward_template.h"

#include "net/real_f64.h"

#include "net/pass/forward_template.h"

#endif
