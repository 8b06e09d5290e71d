// SPDX-License-Identifier: GPL-3.0-or-later
// The ends of a run's steps, which a replay does again, and how many of them it keeps at once.
//
// If all are too many, the path is cut into segments of equal length. Forwards all are done; of each segment
// only where it begins is kept, the last one whole. Backwards each other segment is done again from there, so
// that every step but the last segment's is done twice. Every FEM_REPLAY_BLOCK steps a replay begins anew, as
// a run that is resumed: no result depends on where segments end.
#ifndef TETLAP_FEM_GRADIENT_PATH_REPLAY_STEPS_H
#define TETLAP_FEM_GRADIENT_PATH_REPLAY_STEPS_H

#include "fem/effect/system.h"

enum {
  FEM_REPLAY_BLOCK = 32, // steps; segments have whole blocks
  FEM_REPLAY_LEAD = 5    // steps before one that it is found from
};

typedef struct FemReplaySteps {
  double *times; // [s], owned                                              (count)
  double **u;    // of a static scene, where each step's solution is looked for first; owned  (count)(n)
  int count, unknown_count;
  size_t most;    // that a replay may keep [bytes]; 0: what there is
  size_t bytes;   // that it keeps of all: positions, velocities and histories, and what is here
  size_t largest; // the most of a step
  size_t time_capacity, capacity;
} FemReplaySteps;

// The system's accepted state, if it is a new one. STATUS_MEMORY.
Status fem_replay_steps_add(FemReplaySteps *steps, const FemSystem *system);
void fem_replay_steps_destroy(FemReplaySteps *steps); // also of a zeroed one

typedef struct FemReplayPlan {
  int length, segment_count; // steps of a segment, but of the last one; segments
  size_t bytes;              // that are kept
  size_t least;              // with which there is a plan
} FemReplayPlan;

// The longest segments that fit. Without a plan `bytes` is 0.
FemReplayPlan fem_replay_steps_plan(const FemReplaySteps *steps);

#endif
