// SPDX-License-Identifier: Apache-2.0
// Directional derivatives: outputs along given directions of the input (dual numbers through the network),
// and second derivatives of a combination of outputs contracted with pairs of them.
#ifndef NET_TANGENT_H
#define NET_TANGENT_H

#include "net/work.h"

#include "net/real_f32.h"

#include "net/pass/tangent_template.h"

#include "net/real_f64.h"

#include "net/pass/tangent_template.h"

#endif
