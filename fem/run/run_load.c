// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_load.h"

#include <math.h>

#include "fem/effect/system_energy.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"
#include "fem/run/run_frames.h"
#include "fem/run/run_watch.h"

// The work of a step of load, and how far it may be wrong; that of obstacles and of loads the audit adds
// itself.
static void keep_load_step(FemRunState *run, double step, double work_before, const FemEnergy *energy) {
  const FemStatics *statics = &run->statics;
  run->audit.driven_work += statics->driven_work - work_before;
  fem_audit_load_step(&run->audit, step, statics->work_begin + step * run->audit.driven_power,
                      statics->work_end + step * energy->driven_power + statics->load_change,
                      statics->work_left);
}

// Of obstacles without elements at the equilibrium of a step of load, at a time beside it: where a motion has
// a knot its speed before is not that after.
static Status find_power(FemRunState *run, double time, double *power) {
  FemEnergy energy;
  *power = 0;
  if (run->model->scene->obstacle_count == 0) return STATUS_OK;
  const FemState state = fem_state_beside(&run->trial, time);
  TRY(fem_system_energy(&run->system, &state, &energy));
  *power = energy.driven_power;
  return STATUS_OK;
}

// The end of a step. What rounding leaves before a frame is no step of its own: without motion it is not
// decided what slides and what sticks.
static double find_end(const FemRunState *run, double step, double target, double resolution) {
  double stop = fmin(target, run->target), to = run->time + step;
  return to < stop - resolution ? to : stop;
}

Status fem_run_load_advance(FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  double longest = scene->max_step > 0 ? scene->max_step : scene->end / scene->frames;
  double step = run->next_step > 0 ? fmin(run->next_step, longest) : longest;
  FemForesight foresight = {.displacement = fem_model_position_tolerance(run->model),
                            .resolution = FEM_ROUNDING * scene->end / scene->frames,
                            .static_share = scene->tolerance};
  double target = fem_scene_frame_time(scene, run->next_frame),
         to = find_end(run, step, target, foresight.resolution), from = run->time,
         work_before = run->statics.driven_work;
  to = fem_system_horizon(&run->system, &foresight, run->time, to);
  Status status = fem_statics_step(&run->statics, run->time, to, run->u);
  if (status == STATUS_RETRY) {
    run->next_step = 0.5 * (to - run->time);
    bool is_too_short = run->next_step < FEM_ROUNDING * scene->end / scene->frames;
    return is_too_short ? status_fail(STATUS_SOLVER, "%s", status_message()) : STATUS_OK;
  }
  TRY(status);
  run->time = to;
  run->next_step = 2 * step;
  FemMeasures measures;
  double power_before, power_past;
  TRY(find_power(run, fem_signal_past(run->time), &power_past));
  TRY(find_power(run, fem_signal_before(run->time), &power_before));
  TRY(fem_run_frames_measure(run, &measures));
  measures.energy.driven_power = power_before;
  TRY(fem_recorder_end_step(&run->recorder, &run->trial, &measures));
  fem_recorder_accept_step(&run->recorder);
  keep_load_step(run, run->time - from, work_before, &measures.energy);
  run->audit = fem_audit_next(&run->audit, run->time, &measures.energy);
  fem_run_frames_keep_extremes(run->result, &measures);
  TRY(fem_run_frames_take_row(run, &measures, &run->audit));
  if (run->time >= target) TRY(fem_run_frames_write(run, run->time, &measures));
  TRY(fem_recorder_append_step(&run->recorder));
  run->audit.driven_power = power_past;
  return fem_run_watch(run, &measures);
}
