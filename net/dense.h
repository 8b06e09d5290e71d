// SPDX-License-Identifier: Apache-2.0
// A dense SiLU network on NET_COLUMN_UNIT samples that lie side by side: row f of the input
// is feature f of all of them. What makes features in vector lanes hands them over as they are, and gets the
// gradient in the same form. The slopes of the activations are found with their values, so that the way back
// has no exponential.
#ifndef NET_DENSE_H
#define NET_DENSE_H

#include "net/work.h"

// Whether it is such a network. Derivatives are those of its first output.
bool net_dense_is_possible(const NetShape *shape);

#include "net/real_f32.h"

#include "net/dense_template.h"

#include "net/real_f64.h"

#include "net/dense_template.h"

#endif
