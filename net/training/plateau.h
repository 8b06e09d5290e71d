// SPDX-License-Identifier: Apache-2.0
// A learning rate that falls where a score stops falling, by the rule of PyTorch's ReduceLROnPlateau with its
// default threshold (a relative gain below 1e-4 is none) and without cooldown.
#ifndef NET_PLATEAU_H
#define NET_PLATEAU_H

typedef struct NetPlateau {
  double factor; // of the rate at each cut
  int patience;  // scores without gain that are borne; the next one cuts
  double best;   // score; +∞ before the first
  int stale;     // scores without gain since the best or the last cut
  int cuts;      // so far
} NetPlateau;

// A score, the smaller the better; NaN is no gain.
void net_plateau_add(NetPlateau *plateau, double score);

// The rate now, of `peak` before any cut, never below `least`.
double net_plateau_rate(const NetPlateau *plateau, double peak, double least);

#endif
