// SPDX-License-Identifier: Apache-2.0
// What training minimises, with derivatives with respect to a network's outputs. Sums run over samples in
// their order, in double.
#ifndef NET_LOSS_H
#define NET_LOSS_H

// Huber's function of r and its derivative: r²/2 for |r| ≤ delta, delta (|r| − delta/2) beyond.
double net_loss_huber(double r, double delta, double *derivative);

// Binary cross-entropy of a logit z with a label in [0, 1] and its derivative: log(1 + e^z) − label z,
// without overflow.
double net_loss_cross_entropy(double z, double label, double *derivative);

typedef struct NetLossPaper {
  double total;
  double cross_entropy; // mean
  double rmsle;         // root mean square of the difference of log1p
} NetLossPaper;

#include "net/real_f32.h"

#include "net/training/loss_template.h"

#include "net/real_f64.h"

#include "net/training/loss_template.h"

#endif
