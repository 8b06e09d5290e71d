// SPDX-License-Identifier: Apache-2.0
#include "net/training/loss.h"

#include <math.h>
#include <stddef.h>

double net_loss_huber(double r, double delta, double *derivative) {
  if (!(fabs(r) > delta)) {
    *derivative = r;
    return 0.5 * r * r;
  }
  *derivative = copysign(delta, r);
  return delta * (fabs(r) - 0.5 * delta);
}

double net_loss_cross_entropy(double z, double label, double *derivative) {
  double e = exp(-fabs(z)), sigmoid = z >= 0 ? 1 / (1 + e) : e / (1 + e);
  *derivative = sigmoid - label;
  return fmax(z, 0) + log1p(e) - label * z;
}

#include "net/real_f32.h"

#include "net/training/loss.inc"

#include "net/real_f64.h"

#include "net/training/loss.inc"
