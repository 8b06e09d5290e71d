// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/stall.h"

#include <math.h>
#include <stdbool.h>

#include "fem/model/limits.h"

// Tries that no run may take, each for a share of its time that is rounding; a tenth of those a run that
// creeps; and a tenth of the pace that was possible.
static const double MOST_TRIES = 1 / FEM_ROUNDING, TENTH = 0.1;
// Of a window's tries, without a step.
static const double MOST_VAIN = 0.25;
enum { STRIKES = 2 };

FemStall fem_stall_begin(double time, double end, double frame) {
  return (FemStall){.end = end, .frame = frame, .time = time};
}

void fem_stall_take_back(FemStall *stall) {
  stall->vain++;
}

void fem_stall_pass(FemStall *stall, double duration) {
  stall->time += duration;
}

static bool has_not_advanced(const FemStall *stall, double advance, double max_step) {
  double needed = FEM_STALL_WINDOW * fmin(stall->end / MOST_TRIES, TENTH * max_step);
  return !(advance >= needed);
}

static bool creeps(const FemStall *stall, double advance, double pace) {
  return (double)stall->vain > MOST_VAIN * (double)stall->tries && stall->left > TENTH * MOST_TRIES &&
         pace < TENTH * stall->fastest && advance < stall->frame;
}

FemStallVerdict fem_stall_add(FemStall *stall, long long tries, long long vain, double time,
                              double max_step) {
  stall->tries += tries;
  stall->vain += vain;
  if (stall->tries < FEM_STALL_WINDOW) return FEM_STALL_GOES_ON;
  double advance = time - stall->time, pace = advance / (double)stall->tries;
  stall->left = advance > 0 ? (stall->end - time) / pace : INFINITY;
  bool is_standing = time < stall->end && has_not_advanced(stall, advance, max_step);
  stall->strikes = creeps(stall, advance, pace) ? stall->strikes + 1 : 0;
  stall->fastest = fmax(stall->fastest, pace);
  stall->tries = stall->vain = 0;
  stall->time = time;
  if (is_standing) return FEM_STALL_STANDS;
  return stall->strikes >= STRIKES ? FEM_STALL_CREEPS : FEM_STALL_GOES_ON;
}
