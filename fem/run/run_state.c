// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_state.h"

FemIntegratorStats fem_run_state_stats(const FemRunState *run) {
  FemIntegratorStats stats = run->result->integrator, now = {0};
  if (run->integrator) now = fem_integrator_stats(run->integrator);
  now.steps += run->statics.steps;
  now.newton_iterations += run->statics.newton_iterations;
  fem_run_result_add_integrator(&stats, &now);
  return stats;
}

bool fem_run_state_has_ended(const FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  return scene->is_static ? run->next_frame > scene->frames : !(run->time < scene->end);
}
