// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/model/formulas.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"
#include "fem/run/check/choice.h"
#include "fem/run/check/start.h"
#include "fem/run/checkpoint/restart.h"
#include "fem/run/checkpoint/run_checkpoint.h"
#include "fem/run/hold.h"
#include "fem/run/run_frames.h"
#include "fem/run/run_load.h"
#include "fem/run/run_watch.h"
#include "fem/run/spread.h"

// A step that gains energy (fem/time/audit.h) is taken back and tried again with a smaller step; at most so
// many times in a row.
static const double RETRY_FACTOR = 0.2;
enum { RETRIES_IN_A_ROW = 8 };
// Of the time in which a wave √(E/ρ) crosses the smallest mean edge: what is tried again, and the first step
// of a start, are not shorter than these. Nothing moves in less, whatever accelerations there are.
static const double SHORTEST_RETRY = 2e-3, SHORTEST_START = 5e-4;
// Of √(E/ρ) what a velocity may err by at most, as a share of time.tolerance, which is a length over a
// body's.
static const double WAVE_SHARE = 3;
// A scene in motion without contact may begin at rest with long steps. What it gains is judged by the energy
// of a strain of so many times time.tolerance, which is a length over a body's, at least.
static const double TOLD_STRAIN = 20;
// While all bodies sleep time goes on by this share of the end at most, and by a shorter one where an
// obstacle would move too far.
static const double LONGEST_SLEEP = 0.1, SHORTER_SLEEP = 0.25, SHORTEST_SLEEP = 1e-9;

static double crossing(const FemModel *model) {
  return model->edge / fem_model_fastest_wave(model);
}

// No step that is taken back is tried again with less than this [s], unless forces could not be evaluated.
static double shortest_retry(const FemRunState *run) {
  return SHORTEST_RETRY * crossing(run->model);
}

// Of a step that is taken back, the one to try.
static double retry_step(const FemRunState *run, double shortest) {
  return fmax(RETRY_FACTOR * fem_integrator_stats(run->integrator).last_step, shortest);
}

// Whether a step that gains energy, or whose forces differ from the motion, may be tried again with a shorter
// one.
static bool may_shorten(const FemRunState *run) {
  double last = fem_integrator_stats(run->integrator).last_step;
  return run->retries < RETRIES_IN_A_ROW && retry_step(run, shortest_retry(run)) < last;
}

// Back to the last accepted state with a smaller step.
static Status take_back(FemRunState *run, double step, const char *why) {
  log_debug("t = %.9g s: a step of %.3g s is taken back: %s", run->time,
            fem_integrator_stats(run->integrator).last_step, why);
  run->retries++;
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, step);
}

static void keep_state(FemRunState *run, double time) {
  double *u = run->u, *v = run->v;
  run->u = run->u_new, run->v = run->v_new;
  run->u_new = u, run->v_new = v;
  run->time = time;
  run->retries = 0;
  fem_recorder_accept_step(&run->recorder);
}

// Steps, and measures the state that the step leads to, kept in u_new, v_new. RETRY: too far for the contact
// lists, or no numbers.
static Status step(FemRunState *run, double *time, FemMeasures *measures) {
  TRY(fem_integrator_step(run->integrator, time));
  const double *u, *v;
  TRY(fem_integrator_at(run->integrator, *time, &u, &v));
  size_t bytes = (size_t)run->system.numbering.count * sizeof(double);
  memcpy(run->u_new, u, bytes);
  memcpy(run->v_new, v, bytes);
  fem_system_scatter(&run->system, *time, run->u_new, run->v_new, &run->trial);
  TRY(fem_run_frames_measure(run, measures));
  return fem_recorder_end_step(&run->recorder, &run->trial, measures);
}

// The last accepted state, under trial.
static void scatter_accepted(FemRunState *run) {
  fem_system_scatter(&run->system, run->time, run->u, run->v, &run->trial);
}

// The powers with which the next step begins, where they are not those with which the last one ended.
static Status renew_powers(FemRunState *run) {
  FemEnergy energy;
  bool is_at_knot = run->integrator && fem_integrator_is_at_knot(run->integrator);
  double time = is_at_knot ? fem_signal_past(run->time) : run->time;
  fem_system_scatter(&run->system, time, run->u, run->v, &run->trial);
  TRY(fem_system_energy(&run->system, &run->trial, &energy));
  run->audit.dissipated_power = energy.dissipated_power;
  run->audit.driven_power = energy.driven_power;
  return STATUS_OK;
}

// The integrator of the stage that begins at the run's time; its states are u and v.
static Status begin_stage(FemRunState *run, double step) {
  const FemModel *model = run->model;
  const FemSceneDef *scene = model->scene;
  double next = fem_rest_next_change(run->rest);
  run->stage_end = fmin(fmin(scene->end, next), fem_numbering_next_release(model, run->time));
  if (run->system.numbering.count == 0) return STATUS_OK; // all sleep
  FemIntegratorDef def = {.displacement_tolerance = fem_model_position_tolerance(model),
                          .velocity_tolerance = fem_model_velocity_tolerance(model),
                          .speed_share = fem_model_speed_share(model),
                          .wave_share = WAVE_SHARE * scene->tolerance,
                          .initial_step = step,
                          .min_step = scene->min_step,
                          .max_step = scene->max_step,
                          .least_start = SHORTEST_START * crossing(model),
                          .max_order = scene->max_order,
                          .end = run->stage_end,
                          .stall = &run->stall};
  const FemSolverOps *solver = fem_solver_ops(fem_run_choice(model, &run->system.numbering).kind);
  TRY(fem_integrator_create(&run->integrator, &run->system, &run->trial, solver, &def));
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, step);
}

// Counts what the integrator, or statics, has done, and lets it go.
static void end_stage(FemRunState *run) {
  FemRunResult *result = run->result;
  const FemStatics *statics = &run->statics;
  result->integrator = fem_run_state_stats(run);
  if (run->integrator)
    fem_run_result_add_solver(&result->solver, fem_integrator_solver_stats(run->integrator));
  if (statics->equilibrium.solver) {
    fem_run_result_add_solver(&result->solver, statics->equilibrium.ops->stats(statics->equilibrium.solver));
    result->residual = statics->residual;
    result->residual_allowed = statics->tolerance * statics->force_scale;
    result->relaxation_steps += statics->relaxation_steps;
    result->halvings += statics->halvings;
    result->loose += statics->loose;
  }
  fem_integrator_destroy(run->integrator);
  run->integrator = NULL;
  fem_statics_destroy(&run->statics);
}

// With the coordinates that are free from here on.
static Status begin_account(FemRunState *run) {
  FemMeasures measures;
  scatter_accepted(run);
  TRY(fem_run_frames_measure(run, &measures));
  return fem_recorder_begin_step(&run->recorder, &run->trial, &measures);
}

// Vertices come free, bodies fall asleep or awake: with other unknowns from here on.
static Status renumber(FemRunState *run) {
  end_stage(run);
  scatter_accepted(run);
  TRY(fem_hold_renumber(&run->system, run->rest, &run->trial, &run->audit, run->u, run->v));
  TRY(begin_account(run));
  return begin_stage(run, 0);
}

// Whether forces are held to the motion. Without contact nothing jumps within a step; the force of the
// potential `nodal` does in steps however short, where a pair's ∇V is one-sided.
static bool minds_momentum(const FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  return scene->contact.is_on && scene->contact.potential == CONTACT_POTENTIAL_FIELD;
}

// Whether the step's forces are too far from the motion.
static bool differs_from_motion(const FemRunState *run) {
  return minds_momentum(run) &&
         fem_momentum_is_refused(&run->recorder.ledger.momentum, run->model->scene->end);
}

// Of damping at the step's middle, with its mean velocity: there the strain rate is the step's change of
// strain, E₁ − E₀ = sym(½(F₀ + F₁)ᵀ (F₁ − F₀)), and none in a body that has only turned.
static Status find_damping_at_middle(FemRunState *run, double time, double *power) {
  const double *mean = run->mean_velocity;
  double back = 0.5 * (time - run->time), *halfway = run->halfway;
  for (int i = 0; i < run->system.numbering.count; i++) halfway[i] = run->u_new[i] - back * mean[i];
  fem_system_scatter(&run->system, time - back, halfway, mean, &run->middle);
  return fem_system_damping_power(&run->system, &run->middle, power);
}

// What the step's mean velocity v̄ dissipates: by damping at its middle, else at its end. A power that is
// quadratic in velocities is, in the mean over the step, not less (Jensen): what a step gains with it, it has
// gained for certain.
static Status find_least_power(FemRunState *run, double time, double *power) {
  FemEnergy energy;
  double step = time - run->time, *mean = run->mean_velocity, at_end = 0, at_middle = 0;
  for (int i = 0; i < run->system.numbering.count; i++) mean[i] = (run->u_new[i] - run->u[i]) / step;
  fem_system_scatter(&run->system, time, run->u_new, mean, &run->trial);
  Status status = fem_system_energy(&run->system, &run->trial, &energy);
  if (!status) status = fem_system_damping_power(&run->system, &run->trial, &at_end);
  if (!status) status = find_damping_at_middle(run, time, &at_middle);
  fem_system_scatter(&run->system, time, run->u_new, run->v_new, &run->trial);
  *power = energy.dissipated_power - at_end + at_middle;
  return status;
}

// The audit of the step; `*is_refused`: it gains energy, for certain.
static Status judge_energy(FemRunState *run, double time, const FemEnergy *energy, FemAudit *next,
                           bool *is_refused) {
  const FemAuditBounds *bounds = &run->result->energy_bounds;
  *next = fem_audit_next(&run->audit, time, energy);
  run->least_power = INFINITY;
  if (fem_audit_is_doubtful(bounds, &run->audit, next) && energy->dissipated_power > 0) {
    TRY(find_least_power(run, time, &run->least_power));
    *next = fem_audit_next_within(&run->audit, time, energy, run->least_power);
  }
  *is_refused = fem_audit_is_refused(bounds, &run->audit, next);
  return STATUS_OK;
}

// Whether something that slips has turned within the step, and friction has pushed it on since.
static bool has_turned(const FemRunState *run, double time, const FemEnergy *energy) {
  return energy->turned_power * (time - run->time) > fem_limits.turned * run->audit.scale;
}

// The run's state is accepted.
static Status accept(FemRunState *run, double next_step) {
  scatter_accepted(run); // a frame has been shown since, perhaps
  TRY(fem_system_accept(&run->system, &run->trial, next_step));
  return fem_rest_decide(run->rest, next_step);
}

// One step: taken, judged, shown, accepted.
static Status advance(FemRunState *run) {
  double time = run->time;
  FemMeasures measures;
  if (minds_momentum(run)) {
    double strictness = fem_momentum_strictness(&run->recorder.ledger.momentum, run->model->scene->end);
    fem_integrator_tighten(run->integrator, strictness);
  }
  Status status = step(run, &time, &measures);
  bool may_retry = run->retries < RETRIES_IN_A_ROW;
  if (status == STATUS_RETRY && may_retry) return take_back(run, retry_step(run, 0), status_message());
  TRY(status);
  FemAudit next;
  bool is_refused;
  status = judge_energy(run, time, &measures.energy, &next, &is_refused);
  if (status == STATUS_RETRY && may_retry) return take_back(run, retry_step(run, 0), status_message());
  TRY(status);
  if (is_refused && may_shorten(run)) {
    run->result->energy_retries++;
    return take_back(run, retry_step(run, shortest_retry(run)), "it gains energy");
  }
  if (may_shorten(run) && differs_from_motion(run)) {
    run->result->momentum_retries++;
    return take_back(run, retry_step(run, shortest_retry(run)), "forces and motion differ");
  }
  if (may_shorten(run) && has_turned(run, time, &measures.energy)) {
    run->result->slip_retries++;
    return take_back(run, retry_step(run, shortest_retry(run)),
                     "friction acts along the slip that has reversed");
  }
  status = fem_run_frames_take_row(run, &measures, &next);
  if (!status) status = fem_run_frames_write_until(run, time);
  if (status == STATUS_RETRY && may_retry) return take_back(run, retry_step(run, 0), status_message());
  TRY(status);
  TRY(fem_recorder_append_step(&run->recorder));
  run->audit = next;
  keep_state(run, time);
  fem_run_frames_keep_extremes(run->result, &measures);
  FemIntegratorStats stats = fem_run_state_stats(run);
  run->result->trouble.smallest_step = fmin(run->result->trouble.smallest_step, stats.last_step);
  TRY(accept(run, stats.current_step));
  if (fem_integrator_is_at_knot(run->integrator)) TRY(renew_powers(run));
  TRY(fem_run_watch(run, &measures));
  return fem_rest_has_changed(run->rest) ? renumber(run) : STATUS_OK;
}

// The next state while all bodies sleep: as late as contact lists allow for obstacles that move, and not
// beyond what these do in between.
static Status look_ahead(FemRunState *run, double *time, FemMeasures *measures) {
  const FemSceneDef *scene = run->model->scene;
  double longest = scene->max_step > 0 ? scene->max_step : LONGEST_SLEEP * scene->end;
  FemForesight foresight = {.displacement = fem_model_position_tolerance(run->model),
                            .velocity = fem_model_velocity_tolerance(run->model),
                            .resolution = SHORTEST_SLEEP * scene->end};
  double farthest = fmin(run->time + longest, run->stage_end);
  farthest = fem_system_horizon(&run->system, &foresight, run->time, farthest);
  for (double step = farthest - run->time;; step *= SHORTER_SLEEP) {
    *time = step < run->stage_end - run->time ? run->time + step : run->stage_end;
    fem_system_scatter(&run->system, *time, run->u, run->v, &run->trial);
    Status status = fem_run_frames_measure(run, measures);
    if (status != STATUS_RETRY || step < SHORTEST_SLEEP * scene->end) return status;
  }
}

static Status sleep_on(FemRunState *run) {
  double time, began = run->time;
  FemMeasures measures;
  TRY(look_ahead(run, &time, &measures));
  TRY(fem_recorder_begin_step(&run->recorder, &run->trial, &measures));
  FemAudit next = fem_audit_next(&run->audit, time, &measures.energy);
  run->least_power = INFINITY;
  TRY(fem_run_frames_take_row(run, &measures, &next));
  TRY(fem_run_frames_write_until(run, time));
  TRY(fem_recorder_append_step(&run->recorder));
  run->audit = next;
  run->time = time;
  fem_stall_pass(&run->stall, time - began);
  fem_run_frames_keep_extremes(run->result, &measures);
  TRY(accept(run, time - began));
  TRY(fem_run_watch(run, &measures));
  return fem_rest_has_changed(run->rest) ? renumber(run) : STATUS_OK;
}

// A rest state is not judged by rounding: the energy of a strain of 1e-6 in all bodies counts as the scene's
// at least.
static const double ROUNDED_STRAIN = 1e-6;

// Room for the unknowns, however many are released.
static Status allocate_states(FemRunState *run) {
  double **states[] = {&run->u, &run->v, &run->u_new, &run->v_new, &run->mean_velocity, &run->halfway};
  for (size_t i = 0; i < sizeof states / sizeof *states; i++)
    if (!(*states[i] = memory_zeroed(3 * (size_t)run->model->vertex_count, sizeof(double))))
      return status_no_memory("the state");
  return STATUS_OK;
}

// The states to try steps with, of the system as it is made anew.
static Status create_states(FemRunState *run) {
  fem_state_destroy(&run->trial);
  fem_state_destroy(&run->middle);
  TRY(fem_system_create_state(&run->system, &run->trial));
  return fem_system_create_state(&run->system, &run->middle);
}

// What has been released until now.
static Status release(FemRunState *run) {
  FemNumbering *numbering = &run->system.numbering;
  int count = numbering->count;
  numbering->released = run->time;
  fem_numbering_renew(numbering, run->model);
  return numbering->count == count ? STATUS_OK : fem_system_renumber(&run->system);
}

static void tell_overlaps(const FemSystem *system) {
  char text[512];
  for (int i = 0; (i = fem_run_start_overlap(system, i, text, sizeof text)) >= 0; i++)
    log_warning("%s", text);
}

// The first frame, and the audit from there on.
static Status begin_record(FemRunState *run) {
  FemMeasures measures;
  TRY(fem_run_frames_measure(run, &measures));
  fem_audit_begin(&run->audit, run->time, &measures.energy,
                  fem_model_strain_energy(run->model, ROUNDED_STRAIN));
  fem_run_frames_keep_extremes(run->result, &measures);
  fem_trouble_add(&run->result->trouble, run->time, &measures.trouble);
  if (!run->options->from) tell_overlaps(&run->system);
  // Files of an earlier run in this folder are about to be replaced: all of them go, the checkpoint too.
  if (!run->options->from) {
    TRY(fem_recorder_clear(&run->recorder));
    TRY(fem_run_checkpoint_remove(run));
  }
  return fem_run_frames_write(run, run->time, &measures);
}

// The checkpoint's state is accepted, with what effects remembered then.
static Status begin_system(FemRunState *run, double next_step) {
  scatter_accepted(run);
  TRY(fem_system_begin(&run->system, &run->trial, next_step));
  TRY(fem_restart_remember(&run->checkpoint, &run->system));
  return fem_rest_decide(run->rest, next_step);
}

static Status begin_motion(FemRunState *run) {
  TRY(begin_system(run, run->next_step));
  if (run->next_frame == 0) TRY(begin_record(run));
  FemMeasures measures;
  TRY(fem_run_frames_measure(run, &measures));
  TRY(fem_recorder_begin_step(&run->recorder, &run->trial, &measures));
  return begin_stage(run, run->next_step);
}

static Status begin_statics(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  TRY(fem_statics_create(&run->statics, &run->system, &run->trial,
                         fem_solver_ops(fem_run_choice(run->model, &run->system.numbering).kind)));
  TRY(begin_system(run, 0));
  if (run->next_frame == 0) return begin_record(run);
  TRY(fem_statics_continue(&run->statics, run->time, run->u, from->force_scale, from->driven_work));
  FemMeasures measures;
  TRY(fem_run_frames_measure(run, &measures));
  return fem_recorder_begin_step(&run->recorder, &run->trial, &measures);
}

static Status begin_rest(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  if (!fem_rest_is_wanted(run->model->scene)) return STATUS_OK;
  TRY(fem_rest_create(&run->rest, &run->system));
  if (from->next_frame > 0) TRY(fem_rest_load(run->rest, from->rest, from->rest_count));
  if (!fem_rest_has_changed(run->rest)) return STATUS_OK;
  scatter_accepted(run);
  return fem_hold_sleepers(&run->system, run->rest, &run->trial, run->u, run->v);
}

// Everything anew from the checkpoint: the same whether the run goes on, is resumed, or begins.
static Status begin_part(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  bool is_first = !run->system.model;
  run->time = from->time;
  run->audit = from->audit;
  run->next_frame = from->next_frame;
  run->next_step = from->step;
  run->retries = 0;
  run->least_power = INFINITY;
  TRY(fem_formulas_check(run->model, run->time));
  TRY(is_first ? fem_system_create(&run->system, run->model)
               : fem_system_create_again(&run->system, run->model));
  run->system.stop = run->options->stop;
  TRY(create_states(run));
  TRY(release(run));
  fem_restart_load(from, &run->system.numbering, run->u, run->v);
  TRY(begin_rest(run));
  if (is_first) TRY(fem_run_frames_open(run));
  return run->model->scene->is_static ? begin_statics(run) : begin_motion(run);
}

// Counts what the part has done; the system stays, for the next to take over from.
static void end_part(FemRunState *run) {
  FemRunResult *result = run->result;
  end_stage(run);
  if (run->system.model) fem_run_result_add_system(result, &run->system);
  fem_run_result_add_rest(result, run->rest);
  result->phases.output += run->recorder.seconds;
  run->recorder.seconds = 0;
  const double wall = clock_wall_s(), cpu = clock_cpu_s(), inside = ranks()->stats()->inside_s;
  result->wall_s += wall - run->began_s;
  result->cpu_s += cpu - run->cpu_began_s;
  result->work_s += cpu - run->cpu_began_s - (inside - run->inside_began_s);
  run->began_s = wall;
  run->cpu_began_s = cpu;
  run->inside_began_s = inside;
}

// Collects a checkpoint and begins anew from it.
static Status pass_checkpoint(FemRunState *run) {
  const double force_scale = run->statics.force_scale, driven_work = run->statics.driven_work;
  end_part(run);
  TRY(fem_run_checkpoint_take(run, force_scale, driven_work));
  fem_rest_destroy(run->rest);
  run->rest = NULL;
  TRY(begin_part(run));
  memory_trim();
  return STATUS_OK;
}

static Status march(FemRunState *run) {
  TRY(allocate_states(run));
  TRY(begin_part(run));
  const FemSceneDef *scene = run->model->scene;
  run->stall = fem_stall_begin(run->time, scene->end, scene->end / scene->frames);
  TRY(fem_run_checkpoint_offer(run));
  while (!fem_run_state_has_ended(run)) {
    if (run->model->scene->is_static) {
      TRY(fem_run_load_advance(run));
    } else {
      if (run->time >= run->stage_end) TRY(renumber(run));
      TRY(run->integrator ? advance(run) : sleep_on(run));
    }
    if (fem_run_checkpoint_is_due(run)) TRY(pass_checkpoint(run));
  }
  return fem_run_watch_passages(run);
}

static Status keep_account(FemRunState *run) {
  FemRunResult *result = run->result;
  const FemLedger *ledger = &run->recorder.ledger;
  result->account = record_new();
  if (!result->account) return status_no_memory("the summary");
  fem_ledger_record(ledger, result->account);
  while (result->told_count < FEM_RUN_TOLD &&
         fem_ledger_tell(ledger, result->told_count, result->told[result->told_count], sizeof *result->told))
    result->told_count++;
  return STATUS_OK;
}

static Status collect(FemRunState *run, Status status) {
  FemRunResult *result = run->result;
  end_part(run);
  result->audit = run->audit;
  result->end_time = run->time;
  result->peak_rss_bytes = memory_peak_bytes();
  result->state_unknowns = (result->is_static ? 1 : 2) * run->system.numbering.count;
  result->phases.analysis = result->solver.analyse_s;
  result->phases.factorisation = result->solver.factorise_s;
  result->phases.solve = result->solver.solve_s;
  result->phases.total = result->wall_s;
  if (!status) fem_run_spread_collect(run, result); // else others may be elsewhere
  if (!run->recorder.system) return STATUS_OK;
  if (run->system.model) TRY(keep_account(run)); // else a new part could not be begun
  return fem_recorder_finish(&run->recorder);
}

// The counts to go on from.
static Status begin_result(FemRunState *run) {
  FemRunResult *result = run->result;
  *result = run->checkpoint.so_far;
  result->counters = record_new();
  if (!result->counters) return status_no_memory("the counters");
  record_merge(result->counters, run->checkpoint.so_far.counters);
  FemTrouble now = fem_trouble_begin(run->model);
  if (run->checkpoint.next_frame == 0) result->trouble = now;
  result->trouble.sliver_count = now.sliver_count;
  result->trouble.worst_sliver = now.worst_sliver;
  result->trouble.worst_shape = now.worst_shape;
  result->solver_name = fem_solver_name(fem_run_choice(run->model, NULL).kind);
  result->is_static = run->model->scene->is_static;
  bool has_contact = run->model->scene->contact.is_on;
  double told = has_contact || result->is_static ? 0 : TOLD_STRAIN * run->model->scene->tolerance;
  result->energy_bounds = fem_audit_bounds(has_contact, fem_model_strain_energy(run->model, told));
  return STATUS_OK;
}

static Status check_ranks(const FemRunState *run) {
  if (!run->model->share || run->model->scene->solver != FEM_SOLVER_KLU) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "solver.linear: klu works in one process, and there are %d: write amg, "
                     "gamg, pcg, or cholmod, which is MUMPS' over ranks",
                     ranks()->count);
}

static Status prepare(FemRunState *run) {
  const FemRunOptions *options = run->options;
  TRY(check_ranks(run));
  if (options->from) {
    TRY(fem_restart_check(options->from, run->model));
    TRY(fem_checkpoint_copy(&run->checkpoint, options->from));
  } else {
    TRY(fem_restart_begin(&run->checkpoint, run->model, options->initial_displacement));
    run->checkpoint.step = run->model->scene->is_static ? 0 : run->model->scene->initial_step;
  }
  if (options->origin && !run->checkpoint.origin) {
    run->checkpoint.origin = memory_copy(options->origin, strlen(options->origin) + 1, 1);
    if (!run->checkpoint.origin) return status_no_memory("a checkpoint");
  }
  run->is_written = options->from;
  return begin_result(run);
}

// The first failure gives the status; what closes the run may fail as well.
static Status close_run(FemRunState *run, Status status) {
  char message[2048], closing[1024] = "";
  snprintf(message, sizeof message, "%s", status_message());
  Status collected = collect(run, status), left = fem_run_checkpoint_leave(run, status ? status : collected);
  if (collected || left) snprintf(closing, sizeof closing, "; besides: %s", status_message());
  fem_recorder_destroy(&run->recorder);
  fem_rest_destroy(run->rest);
  fem_state_destroy(&run->trial);
  fem_state_destroy(&run->middle);
  fem_system_destroy(&run->system);
  double *states[] = {run->u, run->v, run->u_new, run->v_new, run->mean_velocity, run->halfway};
  for (size_t i = 0; i < sizeof states / sizeof *states; i++) memory_free(states[i]);
  fem_checkpoint_destroy(&run->checkpoint);
  if (status) return status_fail(status, "%s%s", message, closing);
  return collected ? collected : left;
}

// Says when a run failed, unless whoever failed did. A retry that nobody took is the solver's failure.
static Status say_when(const FemRunState *run, Status status) {
  bool is_stopped = run->options->stop && *run->options->stop && status == STATUS_INTERRUPTED;
  if (is_stopped)
    return status_fail(STATUS_INTERRUPTED, "interrupted at t = %g s; everything written so far is complete",
                       run->time);
  if (status != STATUS_RETRY && status != STATUS_SOLVER) return status;
  bool is_told = strstr(status_message(), "t = ");
  if (is_told) return status_fail(STATUS_SOLVER, "%s", status_message());
  return status_prefix(STATUS_SOLVER, "at t = %.9g s", run->time);
}

Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result) {
  *result = (FemRunResult){.min_det_F = INFINITY};
  FemRunState run = {.model = model,
                     .options = options,
                     .result = result,
                     .began_s = clock_wall_s(),
                     .cpu_began_s = clock_cpu_s(),
                     .inside_began_s = ranks()->stats()->inside_s};
  run.written_s = run.began_s;
  Status status = prepare(&run);
  if (!status) status = march(&run);
  return close_run(&run, say_when(&run, status));
}
