// SPDX-License-Identifier: Apache-2.0
#include "net/training/plateau.h"

#include <math.h>

void net_plateau_add(NetPlateau *plateau, double score) {
  if (score < plateau->best * (1 - 1e-4)) {
    plateau->best = score;
    plateau->stale = 0;
    return;
  }
  if (++plateau->stale <= plateau->patience) return;
  plateau->cuts++;
  plateau->stale = 0;
}

double net_plateau_rate(const NetPlateau *plateau, double peak, double least) {
  return fmax(least, peak * pow(plateau->factor, plateau->cuts));
}
