// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/effect/formulas.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"
#include "fem/run/check/choice.h"
#include "fem/run/check/start.h"
#include "fem/run/checkpoint/restart.h"
#include "fem/run/checkpoint/run_checkpoint.h"
#include "fem/run/rest/hold.h"
#include "fem/run/result/run_clock.h"
#include "fem/run/result/spread.h"
#include "fem/run/run_blame.h"
#include "fem/run/run_frames.h"
#include "fem/run/run_load.h"
#include "fem/run/run_loop.h"
#include "fem/run/run_stage.h"
#include "fem/run/run_step.h"
#include "fem/run/run_watch.h"

// The next state while all bodies sleep: as late as contact lists allow for obstacles that move, and not
// beyond what these do in between.
static Status look_ahead(FemRunState *run, double *time, FemMeasures *measures) {
  const FemSceneDef *scene = run->model->scene;
  double longest = scene->max_step > 0 ? scene->max_step : FEM_LONGEST_STEP * scene->end;
  FemForesight foresight = {.displacement = fem_model_position_tolerance(run->model),
                            .velocity = fem_model_velocity_tolerance(run->model),
                            .resolution = FEM_TIME_RESOLUTION * scene->end};
  const double latest = fmin(run->stage_end, run->target);
  double farthest = fmin(run->time + longest, latest);
  farthest = fem_system_horizon(&run->system, &foresight, run->time, farthest);
  for (double step = farthest - run->time;; step *= FEM_CUT) {
    *time = step < latest - run->time ? run->time + step : latest;
    fem_system_scatter(&run->system, *time, run->u, run->v, &run->trial);
    Status status = fem_run_frames_measure(run, measures);
    if (status != STATUS_RETRY || step < FEM_TIME_RESOLUTION * scene->end) return status;
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
  fem_audit_accept(&run->audit, &next);
  run->time = time;
  fem_stall_pass(&run->stall, time - began);
  fem_run_frames_keep_extremes(run->result, &measures);
  TRY(fem_run_stage_accept(run, time - began));
  TRY(fem_run_watch(run, &measures));
  return fem_rest_has_changed(run->rest) ? fem_run_stage_change(run) : STATUS_OK;
}

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

static Status warn_of_overlaps(const FemSystem *system, const FemState *state) {
  const ContactEvaluation *contact;
  char texts[FEM_RUN_START_TOLD_COUNT][FEM_RUN_START_TEXT_SIZE];
  TRY(fem_effect_contact_evaluate(system, state, &contact));
  int count = fem_run_start_overlaps(system, contact, texts);
  for (int k = 0; k < count; k++) log_warning("%s", texts[k]);
  return STATUS_OK;
}

// The first frame, and the audit from there on.
static Status begin_record(FemRunState *run) {
  FemMeasures measures;
  TRY(fem_run_frames_measure(run, &measures));
  // A rest state is not judged by rounding.
  fem_audit_begin(&run->audit, run->time, &measures.energy,
                  fem_model_strain_energy(run->model, FEM_ROUNDING));
  fem_run_frames_keep_extremes(run->result, &measures);
  fem_trouble_add(&run->result->trouble, run->time, &measures.trouble);
  if (!run->options->from && !run->model->start) TRY(warn_of_overlaps(&run->system, &run->trial));
  TRY(fem_run_blame_clear(run));
  // Files of an earlier run in this folder are about to be replaced: all of them go, the checkpoint too.
  if (!run->options->from) {
    TRY(fem_recorder_clear(&run->recorder));
    TRY(fem_run_checkpoint_remove(run));
  }
  return fem_run_frames_write(run, run->time, &measures);
}

// The checkpoint's state is accepted, with what effects remembered then.
static Status begin_system(FemRunState *run, double next_step) {
  fem_run_stage_scatter(run);
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
  return fem_run_stage_begin(run, run->next_step);
}

// The end state of another run need not be an equilibrium of this scene: frame 0 is.
static Status balance_start(FemRunState *run) {
  Status status = fem_statics_step(&run->statics, run->time, run->time, run->u);
  if (status == STATUS_RETRY)
    return status_fail(STATUS_SOLVER,
                       "from the end state of `start`, t = %.9g s: %s; let the changes come "
                       "in by tables or formulas of t",
                       run->time, status_message());
  return status;
}

static Status begin_statics(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  TRY(fem_statics_create(&run->statics, &run->system, &run->trial,
                         fem_solver_ops(fem_run_choice(run->model, &run->system.numbering).kind)));
  TRY(begin_system(run, 0));
  TRY(fem_statics_continue(&run->statics, run->time, run->u, from->force_scale, from->driven_work));
  if (run->next_frame == 0 && run->model->start) TRY(balance_start(run));
  if (run->next_frame == 0) return begin_record(run);
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
  fem_run_stage_scatter(run);
  return fem_hold_sleepers(&run->system, run->rest, &run->trial, run->u, run->v);
}

// Everything anew from the checkpoint: the same whether the run goes on, is resumed, or begins.
static Status begin_part(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  bool is_first = !run->system.is_whole;
  run->time = from->time;
  run->audit = from->audit;
  run->next_frame = from->next_frame;
  run->next_step = from->step;
  run->least_power = INFINITY;
  TRY(fem_formulas_check(run->model, run->time));
  if (is_first) {
    fem_system_destroy(&run->system); // what is left of one that failed
    TRY(fem_system_create(&run->system, run->model));
  }
  TRY(fem_system_create_again(&run->system)); // the first, too: what is counted is the same
  run->system.stop = run->options->stop;
  TRY(create_states(run));
  TRY(release(run));
  fem_restart_load(from, &run->system.numbering, run->u, run->v);
  TRY(begin_rest(run));
  if (!run->recorder.system) TRY(fem_run_frames_open(run));
  return run->model->scene->is_static ? begin_statics(run) : begin_motion(run);
}

// Counts what the part has done; the system stays, for the next to take over from.
static void end_part(FemRunState *run) {
  FemRunResult *result = run->result;
  fem_run_stage_end(run);
  if (run->system.is_whole) fem_run_result_add_system(result, &run->system);
  fem_rest_report(run->rest, result->counters);
  result->cost.phases.output += run->recorder.seconds;
  run->recorder.seconds = 0;
  const double wall = clock_wall_s(), cpu = clock_cpu_s(), inside = ranks()->stats()->inside_s;
  result->cost.wall_s += wall - run->began_s;
  result->cost.cpu_s += cpu - run->cpu_began_s;
  result->cost.work_s += cpu - run->cpu_began_s - (inside - run->inside_began_s);
  run->began_s = wall;
  run->cpu_began_s = cpu;
  run->inside_began_s = inside;
}

Status fem_run_loop_begin_anew(FemRunState *run) {
  const double force_scale = run->statics.force_scale, driven_work = run->statics.driven_work;
  end_part(run);
  TRY(fem_run_checkpoint_take(run, force_scale, driven_work));
  fem_rest_destroy(run->rest);
  run->rest = NULL;
  return begin_part(run);
}

static Status equilibrate(FemRunState *run) {
  FemRunSpan span = fem_run_clock_begin(run);
  TRY(fem_run_load_advance(run));
  fem_run_clock_end(run, span, &run->result->cost.phases.integration);
  return STATUS_OK;
}

Status fem_run_loop_turn(FemRunState *run) {
  if (run->model->scene->is_static) {
    TRY(equilibrate(run));
  } else {
    if (run->time >= run->stage_end) TRY(fem_run_stage_change(run));
    TRY(run->integrator ? fem_run_step_advance(run) : sleep_on(run));
  }
  const FemIntegratorStats stats = fem_run_state_stats(run);
  if (!fem_run_checkpoint_is_due(run, &stats)) return STATUS_OK;
  TRY(fem_run_loop_begin_anew(run));
  memory_trim();
  return STATUS_OK;
}

static Status keep_account(FemRunState *run) {
  FemRunResult *result = run->result;
  const FemLedger *ledger = &run->recorder.ledger;
  result->account.record = record_new();
  if (!result->account.record) return status_no_memory("the summary");
  fem_ledger_record(ledger, result->account.record);
  while (result->account.contact_count < FEM_RUN_DESCRIBED_COUNT &&
         fem_ledger_describe(ledger, result->account.contact_count,
                             result->account.contacts[result->account.contact_count],
                             sizeof *result->account.contacts))
    result->account.contact_count++;
  return STATUS_OK;
}

static Status collect(FemRunState *run, Status status) {
  FemRunResult *result = run->result;
  Status written = run->recorder.system ? fem_recorder_finish(&run->recorder) : STATUS_OK;
  end_part(run);
  result->energy.audit = run->audit;
  result->end_time = run->time;
  result->cost.peak_rss_bytes = memory_peak_bytes();
  result->state_unknowns = (result->is_static ? 1 : 2) * run->system.numbering.count;
  result->cost.phases.analysis = result->matrix.solver.analyse_s;
  result->cost.phases.factorisation = result->matrix.solver.factorise_s;
  result->cost.phases.solve = result->matrix.solver.solve_s;
  result->cost.phases.total = result->cost.wall_s;
  if (!status) fem_run_spread_collect(run, result); // after a failure other ranks may not come here
  // Without a system, a new part could not be begun.
  if (run->recorder.system && run->system.is_whole) TRY(keep_account(run));
  return written;
}

// The counts to go on from.
static Status begin_result(FemRunState *run) {
  FemRunResult *result = run->result;
  *result = run->checkpoint.so_far;
  result->counters = record_new();
  if (!result->counters) return status_no_memory("the counters");
  record_merge(result->counters, run->checkpoint.so_far.counters);
  const FemTrouble now = run->mesh_trouble;
  if (run->checkpoint.next_frame == 0) result->trouble = now;
  result->trouble.sliver_count = now.sliver_count;
  result->trouble.worst_sliver = now.worst_sliver;
  result->trouble.worst_shape = now.worst_shape;
  result->matrix.solver_name = fem_solver_name(fem_run_choice(run->model, NULL).kind);
  result->is_static = run->model->scene->is_static;
  bool has_contact = run->model->scene->contact.is_on;
  double told = has_contact || result->is_static ? 0 : FEM_WITHOUT_CONTACT * run->model->scene->tolerance;
  result->energy.bounds = fem_audit_bounds(has_contact, fem_model_strain_energy(run->model, told));
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

static void begin_stall(FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  run->stall = fem_stall_begin(run->time, scene->end, scene->end / scene->frames);
}

Status fem_run_loop_begin(FemRunState *run, const FemModel *model, const FemRunOptions *options,
                          FemRunResult *result) {
  *result = (FemRunResult){.min_det_F = INFINITY};
  *run = (FemRunState){.model = model,
                       .options = options,
                       .result = result,
                       .target = INFINITY,
                       .began_s = clock_wall_s(),
                       .cpu_began_s = clock_cpu_s(),
                       .inside_began_s = ranks()->stats()->inside_s};
  run->written_s = run->began_s;
  run->mesh_trouble = fem_trouble_begin(model);
  TRY(prepare(run));
  TRY(allocate_states(run));
  FemRunSpan span = fem_run_clock_begin(run);
  TRY(begin_part(run));
  fem_run_clock_end(run, span, &run->result->cost.phases.start);
  begin_stall(run);
  return fem_run_checkpoint_offer(run);
}

// What measures states goes on with what the checkpoint knows; files of its own are opened anew.
static Status restore_recorder(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  if (run->options->directory || run->options->keep_trajectory || from->next_frame == 0)
    fem_recorder_destroy(&run->recorder);
  return run->recorder.system ? fem_ledger_load(&run->recorder.ledger, from->ledger, from->ledger_count)
                              : STATUS_OK;
}

Status fem_run_loop_restore(FemRunState *run, const FemCheckpoint *from) {
  FemCheckpoint copy;
  TRY(fem_restart_check(from, run->model));
  TRY(fem_checkpoint_copy(&copy, from));
  end_part(run);
  fem_rest_destroy(run->rest);
  run->rest = NULL;
  fem_checkpoint_destroy(&run->checkpoint);
  run->checkpoint = copy;
  TRY(restore_recorder(run));
  fem_run_result_destroy(run->result);
  TRY(begin_result(run));
  TRY(begin_part(run));
  begin_stall(run);
  return STATUS_OK;
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
  if (status) return fem_run_result_blame_model(run->result, status_fail(status, "%s%s", message, closing));
  return collected ? collected : left;
}

Status fem_run_loop_explain(const FemRunState *run, Status status) {
  if (status == STATUS_INTERRUPTED) TRY(fem_run_watch_stop(run));
  if (status != STATUS_RETRY && status != STATUS_SOLVER) return status;
  bool is_told = strstr(status_message(), "t = ");
  if (is_told)
    status_fail(STATUS_SOLVER, "%s", status_message());
  else
    status_prefix(STATUS_SOLVER, "at t = %.9g s", run->time);
  return fem_run_blame_pair(run, STATUS_SOLVER);
}

Status fem_run_loop_end(FemRunState *run, Status status) {
  if (!status && fem_run_state_has_ended(run)) status = fem_run_watch_passages(run);
  return close_run(run, status);
}

Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result) {
  FemRunState run;
  Status status = fem_run_loop_begin(&run, model, options, result);
  while (!status && !fem_run_state_has_ended(&run)) status = fem_run_loop_turn(&run);
  return fem_run_loop_end(&run, fem_run_loop_explain(&run, status));
}
