// SPDX-License-Identifier: GPL-3.0-or-later
// Whether V or ∇V jumps as a pair moves. A path leads a pair of tetrahedra through an overlap:
//
//   approach     the first comes from one side, passes through and leaves on the other
//   rotation     the first turns by 2 rad about its centroid and one of the coordinate axes
//   deformation  all vertices move, half the way to another pair
//
// It is cut into 64 intervals. In each that has an overlap the half with the larger change is taken again
// and again, until the interval is 5e-9 long: a jump is what is left of the change then. Of V the part that
// ∇V explains is taken off. Half of the paths start from pairs of the law `scene`, half from random ones
// that overlap. Some paths are replaced: those that touch nothing, and those with kinks of the true V, where
// a tetrahedron gets flat (det of its edges below 1e-3 of the longest one cubed) or turns inside out.
#ifndef TETLAP_APP_EVALUATION_PATHS_H
#define TETLAP_APP_EVALUATION_PATHS_H

#include <stdint.h>

#include "overlap/model.h"

// Above these a jump counts.
extern const double app_evaluation_volume_jump, app_evaluation_gradient_jump;

typedef struct AppEvaluationPaths {
  int count;            // paths
  int replaced;         // drawn and not used
  int jumping;          // paths with a jump of either
  double volume_jump;   // the largest, by the path's largest V
  double gradient_jump; // the largest, by the path's largest ‖∇V‖
} AppEvaluationPaths;

// Deterministic for a seed, whatever the number of threads. STATUS_SOLVER: not enough usable paths were
// found.
Status app_evaluation_paths(const OverlapModel *model, int count, uint64_t seed, AppEvaluationPaths *result);

#endif
