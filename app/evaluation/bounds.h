// SPDX-License-Identifier: GPL-3.0-or-later
// How well a model's bound of its own error holds (overlap/ops.h: eval_bounds): with ε = |V − V*|/V of the
// network alone and w = B/V, the share of pairs with ε ≤ w and how wide w is beside ε.
#ifndef TETLAP_APP_EVALUATION_BOUNDS_H
#define TETLAP_APP_EVALUATION_BOUNDS_H

#include "datagen/pairs.h"
#include "overlap/model.h"

typedef struct AppEvaluationBounds {
  size_t count; // pairs that share volume and have a bound
  double coverage;
  double width_median, width_p95; // of w
  double error_median, error_p95; // of ε
} AppEvaluationBounds;

// What has been seen so far; zeroed: nothing.
typedef struct AppEvaluationBoundsRun {
  double *widths, *errors; // (count), owned
  size_t count, width_capacity, error_capacity;
} AppEvaluationBoundsRun;

// Whether the model gives a bound of its error.
bool app_evaluation_bounds_are_told(const OverlapModel *model);

// Does nothing for a model without bounds.
Status app_evaluation_bounds_add(AppEvaluationBoundsRun *run, const OverlapModel *model,
                                 const DatagenPairs *pairs, size_t count);
// NaN where nothing was seen.
AppEvaluationBounds app_evaluation_bounds_finish(AppEvaluationBoundsRun *run);
void app_evaluation_bounds_end(AppEvaluationBoundsRun *run); // a zeroed one is accepted

#endif
