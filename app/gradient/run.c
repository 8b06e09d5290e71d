// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/run.h"

#include <math.h>

#include "fem/model/limits.h"
#include "fem/run/session.h"

// The first time after `time` at which a goal is taken; INFINITY: there is none.
static double next_time(const FemModel *model, const FemGradientDef *def, double time) {
  double end = model->scene->end, next = INFINITY;
  for (int g = 0; g < def->goal_count; g++)
    for (int t = 0; t < def->goals[g].term_count; t++) {
      double own = fmin(def->goals[g].terms[t].time, end);
      if (own > time + FEM_TIME_RESOLUTION * end) next = fmin(next, own);
    }
  return next;
}

static Status advance(FemRunSession *session, const FemModel *model, const FemGradientDef *def) {
  if (def->goal_count == 0) return fem_run_session_advance(session, model->scene->end);
  for (double time = next_time(model, def, 0); isfinite(time); time = next_time(model, def, time))
    TRY(fem_run_session_advance(session, time));
  return STATUS_OK;
}

Status app_gradient_run(const FemModel *model, const FemGradientDef *def, const FemRunOptions *options,
                        FemRunResult *result) {
  FemRunSession *session;
  TRY(fem_run_session_open(&session, model, options, result));
  return fem_run_session_close(session, advance(session, model, def));
}
