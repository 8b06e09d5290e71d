// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/bounds.h"

#include <math.h>

#include "base/memory.h"
#include "base/sorted.h"

// What clip, which has a part in pairs with nearly coplanar faces, may be off, over V.
static const double CLIP_ERROR = 1e-9;

bool app_evaluation_bounds_are_told(const OverlapModel *model) {
  const OverlapOps *ops = model->ops;
  return ops->eval_bounds && (!ops->has_bounds || ops->has_bounds(model->self));
}

static Status add(AppEvaluationBoundsRun *run, const OverlapModel *model, const DatagenPairs *pairs,
                  size_t count, double *volumes, double *bounds) {
  TRY(model->ops->eval_bounds(model->self, (int)count, pairs->coordinates, volumes, bounds));
  if (!memory_reserve((void **)&run->widths, &run->width_capacity, run->count + count, sizeof(double)) ||
      !memory_reserve((void **)&run->errors, &run->error_capacity, run->count + count, sizeof(double)))
    return status_no_memory("an evaluation");
  for (size_t i = 0; i < count; i++) {
    if (!(pairs->volume[i] > 0 && volumes[i] > 0 && bounds[i] > 0)) continue;
    run->widths[run->count] = bounds[i] / volumes[i];
    run->errors[run->count++] = fabs(volumes[i] - pairs->volume[i]) / volumes[i];
  }
  return STATUS_OK;
}

Status app_evaluation_bounds_add(AppEvaluationBoundsRun *run, const OverlapModel *model,
                                 const DatagenPairs *pairs, size_t count) {
  if (!app_evaluation_bounds_are_told(model)) return STATUS_OK;
  double *volumes = memory_zeroed(count, sizeof *volumes), *bounds = memory_zeroed(count, sizeof *bounds);
  Status status =
      volumes && bounds ? add(run, model, pairs, count, volumes, bounds) : status_no_memory("an evaluation");
  memory_free(volumes), memory_free(bounds);
  return status;
}

AppEvaluationBounds app_evaluation_bounds_finish(AppEvaluationBoundsRun *run) {
  if (run->count == 0) return (AppEvaluationBounds){0, NAN, NAN, NAN, NAN, NAN};
  size_t kept = 0, half = run->count / 2, most = (size_t)(0.95 * (double)(run->count - 1) + 0.5);
  for (size_t i = 0; i < run->count; i++) kept += run->errors[i] <= run->widths[i] + CLIP_ERROR;
  sorted_values(run->errors, run->count);
  sorted_values(run->widths, run->count);
  return (AppEvaluationBounds){.count = run->count,
                               .coverage = (double)kept / (double)run->count,
                               .width_median = run->widths[half],
                               .width_p95 = run->widths[most],
                               .error_median = run->errors[half],
                               .error_p95 = run->errors[most]};
}

void app_evaluation_bounds_end(AppEvaluationBoundsRun *run) {
  memory_free(run->widths), memory_free(run->errors);
  *run = (AppEvaluationBoundsRun){0};
}
