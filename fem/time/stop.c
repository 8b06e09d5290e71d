// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/stop.h"

#include <math.h>

#include "fem/scene/signal.h"

// Where a step of `planned` [s] would leave less than itself to the stop, two equal ones go there: one that
// is short would have to grow again.
static void halve(const FemStopDef *def, double planned, FemStop *stop) {
  double half = 0.5 * (stop->time - def->begin);
  if (!(2 * half > planned && half < planned && half > def->least)) return;
  stop->time = def->begin + half;
  stop->is_knot = false;
}

// No step longer than effects can follow, nor one that changes with each step by a little: of the lengths
// 2^(k/2) s the longest that will do, for a matrix serves steps of one length.
static void limit(const FemStopDef *def, FemStop *stop) {
  double longest = fem_system_longest_step(def->system);
  if (!(longest < def->max_step)) return;
  double even = stop->longest = fmax(exp2(0.5 * floor(2 * log2(longest))), def->least);
  halve(def, fmin(def->planned, even), stop);
  if (!(def->planned > longest) || !(stop->time - def->begin > even)) return;
  stop->time = def->begin + even;
  stop->is_knot = false;
}

FemStop fem_stop_choose(const FemStopDef *def) {
  FemForesight foresight = {
      .displacement = def->displacement, .velocity = def->velocity, .resolution = def->least};
  double farthest = fmin(def->begin + 2 * def->planned, def->end);
  double knot = fem_system_horizon(def->system, &foresight, def->begin, farthest);
  bool has_knot = knot < farthest && def->end - knot > def->least;
  FemStop stop = {
      .time = has_knot ? fem_signal_before(knot) : def->end, .longest = def->max_step, .is_knot = has_knot};
  if (def->may_halve) halve(def, def->planned, &stop);
  limit(def, &stop);
  return stop;
}
