// SPDX-License-Identifier: Apache-2.0
// Whitening of a network's inputs: w = M (f − mean). M is fitted so that over the samples the components of w
// are uncorrelated with unit variance: standardise, rotate to the principal axes, divide by √(λ + 1e-6).
// Training sees w; the trained network takes f, with M and mean folded into its first layer. In double:
// directions of tiny variance are blown up by up to 1e3, so folded weights cancel; a folded network should be
// evaluated in double.
#ifndef NET_WHITENING_H
#define NET_WHITENING_H

#include "net/model/model.h"

typedef struct NetWhitening {
  int count;      // features
  double *mean;   // (count), owned
  double *matrix; // (count, count), owned
} NetWhitening;

// From samples (sample_count, count), at least two. A feature that does not vary keeps unit scale. Destroy
// it; a zeroed one can be destroyed.
NetStatus net_whitening_fit(int count, int sample_count, const double *samples, NetWhitening *whitening);
void net_whitening_destroy(NetWhitening *whitening);

// Zeroed mean and matrix of a size.
NetStatus net_whitening_create(int count, NetWhitening *whitening);

// out (sample_count, count) = M (in − mean). `out` may not be `in`.
void net_whitening_apply(const NetWhitening *whitening, int sample_count, const double *in, double *out);

// Changes the first layer of an mlp that takes w so that it takes f: W ← W M, b ← b − W M mean.
NetStatus net_whitening_fold(const NetWhitening *whitening, NetModel_f64 *model);

#endif
