// SPDX-License-Identifier: Apache-2.0
// The derivative of a loss with respect to the parameters, in two halves: forward over a whole batch, which
// is kept; then the caller's loss, which may couple all samples; then backward. The loss may contain tangents
// (Sobolev training): one backward pass over dual numbers gives the exact derivative.
#ifndef NET_GRADIENT_H
#define NET_GRADIENT_H

#include "net/work.h"

#include "net/real_f32.h"

#include "net/pass/gradient_template.h"

#include "net/real_f64.h"

#include "net/pass/gradient_template.h"

#endif
