// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect_contact.h"
#include "fem/statics.h"

// A step that lifts the audited energy by more than this share of the scene's energy above its lowest value,
// and by more than the second in one go, is taken back and tried again with a smaller step; at most so many
// times in a row.
static const double ENERGY_RISE_ALLOWED = 3e-4, ENERGY_RISE_OF_STEP = 1e-5, RETRY_FACTOR = 0.2;
enum { RETRIES_IN_A_ROW = 8 };
// A static run gives up where a step of load becomes shorter than this share of the time between two frames.
static const double SHORTEST_LOAD_STEP = 1e-4;

// `auto` factorises up to this many unknowns. Beyond, a factor takes gigabytes and PCG, poor as it is for
// slow and nearly incompressible scenes, is what fits.
enum { MOST_UNKNOWNS_TO_FACTORISE = 200000 };

typedef struct Run {
  const FemModel *model;        // borrowed, or `own`
  FemModel own;                 // where vertices are released while the run goes on
  const FemRunOptions *options; // borrowed
  FemRunResult *result;         // borrowed
  FemSystem system;
  FemIntegrator *integrator; // NULL in a static scene
  FemStatics statics;        // of a static scene
  FemRecorder recorder;
  FemAudit audit;
  double time;           // of the last accepted state
  double *u, *v;         // the last accepted state         (unknown_count)
  double *u_new, *v_new; // the state under judgement  (unknown_count)
  int next_frame;
  int retries;               // in a row
  double stage_end;          // the next release of vertices, or the end [s]
  FemIntegratorStats before; // counted in earlier stages
  FemSolverStats solver_before;
} Run;

FemSolverKind fem_run_solver(const FemModel *model) {
  FemSolverKind kind = model->scene->solver;
  if (kind != FEM_SOLVER_AUTO) return kind;
  return model->unknown_count > MOST_UNKNOWNS_TO_FACTORISE ? FEM_SOLVER_PCG : FEM_SOLVER_CHOLMOD;
}

// Counted over all stages.
static FemIntegratorStats stats_of(const Run *run) {
  FemIntegratorStats stats = {0}, before = run->before;
  if (run->integrator) stats = fem_integrator_stats(run->integrator);
  stats.steps += before.steps, stats.setups += before.setups, stats.residuals += before.residuals;
  stats.newton_iterations += before.newton_iterations, stats.newton_failures += before.newton_failures;
  stats.error_test_failures += before.error_test_failures;
  stats.restarts += before.restarts, stats.roots += before.roots;
  return stats;
}

static FemSolverStats solver_stats_of(const Run *run) {
  FemSolverStats stats = *fem_integrator_solver_stats(run->integrator), before = run->solver_before;
  stats.analyses += before.analyses, stats.factorisations += before.factorisations;
  stats.failed_factorisations += before.failed_factorisations;
  stats.solves += before.solves, stats.iterations += before.iterations;
  stats.analyse_s += before.analyse_s, stats.factorise_s += before.factorise_s;
  stats.solve_s += before.solve_s;
  return stats;
}

static double frame_time(const Run *run, int frame) {
  const FemSceneDef *scene = run->model->scene;
  return frame == scene->frames ? scene->end : scene->end * frame / scene->frames;
}

static void keep_frame(Run *run, double time) {
  FemRunResult *result = run->result;
  if (!result->trajectory) return;
  int frame = result->frame_count++;
  size_t values = 3 * (size_t)result->vertex_count;
  result->frame_times[frame] = time;
  memcpy(result->trajectory + (size_t)frame * values, run->system.positions, values * sizeof(double));
  void *effect = fem_system_effect(&run->system, "contact");
  if (!effect) return;
  int count;
  contact_system_interfaces(fem_effect_contact_system(effect), &count);
  for (int i = 0; i < count; i++)
    fem_recorder_interface_force(&run->system, i,
                                 result->interface_forces + 3 * ((size_t)frame * (size_t)count + (size_t)i));
}

static void keep_extremes(FemRunResult *result, const FemMeasures *measures) {
  result->pairs_max = measures->active_pairs > result->pairs_max ? measures->active_pairs : result->pairs_max;
  result->overlap_volume_max = fmax(result->overlap_volume_max, measures->overlap_volume);
  result->contact_force_max = fmax(result->contact_force_max, measures->contact_force);
  result->deepest_overlap_max = fmax(result->deepest_overlap_max, measures->deepest_overlap);
  result->min_det_F = fmin(result->min_det_F, measures->min_det_F);
}

// Writes the frame of the scattered state.
static Status write_frame(Run *run, double time, const FemMeasures *measures) {
  FemIntegratorStats stats = stats_of(run);
  FemAudit audit = time > run->audit.time ? fem_audit_next(&run->audit, time, &measures->energy) : run->audit;
  TRY(fem_recorder_write(&run->recorder, time, measures, &audit, stats.last_step, stats.steps,
                         run->result->trouble.of[FEM_TROUBLE_ENERGY].events));
  run->result->last_contact_force = measures->contact_force;
  keep_frame(run, time);
  run->next_frame++;
  return STATUS_OK;
}

// Measures at a frame within the last step; the contact lists are renewed there if it lies beyond their
// margin.
static Status measure_within_step(Run *run, double time, FemMeasures *measures) {
  const double *u, *v;
  TRY(fem_integrator_at(run->integrator, time, &u, &v));
  fem_system_scatter(&run->system, time, u, v);
  Status status = fem_recorder_measure(&run->recorder, time, measures);
  if (status != STATUS_RETRY) return status;
  TRY(fem_system_accept(&run->system, time, u, v, 0));
  return fem_recorder_measure(&run->recorder, time, measures);
}

static Status write_frames_until(Run *run, double time) {
  double slack = 1e-12 * run->model->scene->end;
  while (run->next_frame <= run->model->scene->frames && frame_time(run, run->next_frame) <= time + slack) {
    double at = fmin(frame_time(run, run->next_frame), time);
    FemMeasures measures;
    TRY(measure_within_step(run, at, &measures));
    TRY(write_frame(run, at, &measures));
  }
  return STATUS_OK;
}

static bool gains_energy(const FemAudit *before, const FemAudit *after) {
  double rise = after->total - before->lowest;
  return rise > ENERGY_RISE_ALLOWED * after->scale &&
         after->total - before->total > ENERGY_RISE_OF_STEP * after->scale;
}

// Back to the last accepted state with a smaller step.
static Status take_back(Run *run) {
  run->retries++;
  double step = RETRY_FACTOR * fem_integrator_stats(run->integrator).last_step;
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, step);
}

// Counts what struck in the accepted state; `*has_begun`: something that had not in the state before.
static Status judge(Run *run, FemMeasures *measures, bool *has_begun) {
  FemTrouble *trouble = &run->result->trouble;
  double rise = (run->audit.total - run->audit.lowest) / run->audit.scale;
  measures->trouble.count[FEM_TROUBLE_ENERGY] = !(rise <= FEM_TROUBLE_ENERGY_BOUND);
  *has_begun = fem_trouble_add(trouble, run->time, &measures->trouble);
  if (!run->options->is_strict || !measures->trouble.count[FEM_TROUBLE_ENERGY]) return STATUS_OK;
  return status_fail(
      STATUS_SOLVER,
      "at t = %.9g s: the energy has risen by %.2g of the scene's, the bound is %g (--strict). Try "
      "a smaller time.tolerance or time.max_step, or a smaller contact.stiffness",
      run->time, rise, FEM_TROUBLE_ENERGY_BOUND);
}

static Status observe(Run *run, FemMeasures *measures) {
  bool has_begun;
  TRY(judge(run, measures, &has_begun));
  if (run->options->stop && *run->options->stop)
    return status_fail(STATUS_INTERRUPTED, "interrupted at t = %g s; what was written until then is whole",
                       run->time);
  if (!run->options->observe) return STATUS_OK;
  FemIntegratorStats stats = stats_of(run);
  FemRunProgress progress = {.system = &run->system,
                             .time = run->time,
                             .end = run->model->scene->end,
                             .step = stats.last_step,
                             .step_count = stats.steps,
                             .active_pairs = measures->active_pairs,
                             .measures = measures,
                             .audit = &run->audit,
                             .trouble = &run->result->trouble,
                             .has_trouble_begun = has_begun};
  return run->options->observe(run->options->observer, &progress);
}

static void keep_state(Run *run, double time) {
  double *u = run->u, *v = run->v;
  run->u = run->u_new, run->v = run->v_new;
  run->u_new = u, run->v_new = v;
  run->time = time;
  run->retries = 0;
}

// Steps, and measures the state that the step leads to, kept in u_new, v_new. RETRY: too far for the contact
// lists.
static Status step(Run *run, double *time, bool *is_onset, FemMeasures *measures) {
  TRY(fem_integrator_step(run->integrator, time, is_onset));
  const double *u, *v;
  TRY(fem_integrator_at(run->integrator, *time, &u, &v));
  size_t bytes = (size_t)run->model->unknown_count * sizeof(double);
  memcpy(run->u_new, u, bytes);
  memcpy(run->v_new, v, bytes);
  fem_system_scatter(&run->system, *time, run->u_new, run->v_new);
  return fem_recorder_measure(&run->recorder, *time, measures);
}

// The powers with which the next step begins, where they are not those with which the last one ended.
static Status renew_powers(Run *run) {
  FemEnergy energy;
  TRY(fem_system_energy(&run->system, run->time, &energy));
  run->audit.dissipated_power = energy.dissipated_power;
  run->audit.driven_power = energy.driven_power;
  return STATUS_OK;
}

// One step: taken, judged, shown, accepted.
static Status advance(Run *run) {
  double time = run->time;
  bool is_onset;
  FemMeasures measures;
  Status status = step(run, &time, &is_onset, &measures);
  bool may_retry = run->retries < RETRIES_IN_A_ROW;
  if (status == STATUS_RETRY && may_retry) return take_back(run);
  TRY(status);
  FemAudit next = fem_audit_next(&run->audit, time, &measures.energy);
  if (gains_energy(&run->audit, &next) && may_retry) {
    run->result->energy_retries++;
    return take_back(run);
  }
  TRY(write_frames_until(run, time));
  run->audit = next;
  keep_state(run, time);
  keep_extremes(run->result, &measures);
  FemIntegratorStats stats = stats_of(run);
  if (!is_onset)
    run->result->trouble.smallest_step = fmin(run->result->trouble.smallest_step, stats.last_step);
  TRY(fem_system_accept(&run->system, time, run->u, run->v, stats.current_step));
  if (fem_system_lags(&run->system)) TRY(renew_powers(run));
  TRY(observe(run, &measures));
  return is_onset ? fem_integrator_restart(run->integrator, time, run->u, run->v, 0) : STATUS_OK;
}

// "a, b" for each interface.
static Status keep_names(FemRunResult *result, void *effect) {
  enum { NAME_SIZE = 256 };
  int count;
  const ContactInterface *interfaces = contact_system_interfaces(fem_effect_contact_system(effect), &count);
  result->interface_names = memory_zeroed((size_t)count, sizeof *result->interface_names);
  if (!result->interface_names) return status_no_memory("the names of interfaces");
  result->interface_count = count;
  for (int i = 0; i < count; i++) {
    result->interface_names[i] = memory_zeroed(NAME_SIZE, 1);
    if (!result->interface_names[i]) return status_no_memory("the names of interfaces");
    snprintf(result->interface_names[i], NAME_SIZE, "%s, %s",
             fem_effect_contact_name(effect, interfaces[i].a),
             fem_effect_contact_name(effect, interfaces[i].b));
  }
  return STATUS_OK;
}

static Status keep_trajectory(Run *run) {
  FemRunResult *result = run->result;
  void *effect = fem_system_effect(&run->system, "contact");
  if (effect) TRY(keep_names(result, effect));
  size_t frames = (size_t)run->model->scene->frames + 1;
  result->vertex_count = run->model->vertex_count;
  result->frame_times = memory_zeroed(frames, sizeof(double));
  result->trajectory = memory_zeroed(frames * 3 * (size_t)result->vertex_count, sizeof(double));
  result->interface_forces = memory_zeroed(frames * 3 * (size_t)result->interface_count, sizeof(double));
  bool ok = result->frame_times && result->trajectory && result->interface_forces;
  return ok ? STATUS_OK : status_no_memory("the kept trajectory");
}

// A rest state is not judged by rounding: a millionth of the bodies' E·V counts as the scene's energy at
// least, less where gravity or motion is smaller.
static double energy_floor(const FemModel *model) {
  double floor = 0;
  for (int b = 0; b < model->scene->body_count; b++)
    floor +=
        1e-12 * model->bodies[b].material.young * model->bodies[b].mass / model->bodies[b].material.density;
  return floor;
}

// The integrator of the stage that begins at the run's time; its states are u and v.
static Status begin_stage(Run *run, double step) {
  const FemModel *model = run->model;
  const FemSceneDef *scene = model->scene;
  run->stage_end = fmin(scene->end, fem_model_next_release(model, run->time));
  FemIntegratorDef def = {.displacement_tolerance = scene->tolerance * model->length,
                          .velocity_tolerance = fem_model_velocity_tolerance(model),
                          .initial_step = step,
                          .min_step = scene->min_step,
                          .max_step = scene->max_step,
                          .max_order = scene->max_order,
                          .end = run->stage_end};
  const FemSolverOps *solver = fem_solver_ops(fem_run_solver(model));
  run->result->solver_name = solver->name;
  TRY(fem_integrator_create(&run->integrator, &run->system, solver, &def));
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, step);
}

// The unknowns of the scattered state.
static void gather(const Run *run, double *u, double *v) {
  const FemModel *model = run->model;
  for (int i = 0; i < model->unknown_count; i++) {
    int dof = model->dof_of_unknown[i];
    u[i] = run->system.positions[dof] - model->rest[dof];
    v[i] = run->system.velocities[dof];
  }
}

// Vertices come free with the place and the velocity that they were driven to.
static Status release(Run *run) {
  FemEnergy before, after;
  fem_system_scatter(&run->system, run->time, run->u, run->v);
  TRY(fem_system_energy(&run->system, run->time, &before));
  run->before = stats_of(run);
  run->solver_before = solver_stats_of(run);
  fem_integrator_destroy(run->integrator);
  run->integrator = NULL;
  fem_model_release(&run->own, run->time);
  TRY(fem_system_renumber(&run->system));
  gather(run, run->u, run->v);
  TRY(fem_system_energy(&run->system, run->time, &after));
  fem_audit_release(&run->audit, after.kinetic - before.kinetic);
  return begin_stage(run, 0);
}

static Status allocate_states(Run *run) {
  size_t n =
      run->model == &run->own ? 3 * (size_t)run->model->vertex_count : (size_t)run->model->unknown_count;
  double **states[] = {&run->u, &run->v, &run->u_new, &run->v_new};
  for (int i = 0; i < 4; i++)
    if (!(*states[i] = memory_zeroed(n, sizeof(double)))) return status_no_memory("the state");
  return STATUS_OK;
}

// The recorder, the audit and the first frame, from the state u, v at the run's time.
static Status begin_record(Run *run) {
  const FemModel *model = run->model;
  const FemSceneDef *scene = model->scene;
  TRY(fem_recorder_create(&run->recorder, &run->system, run->options->directory, scene->frames + 1));
  if (run->options->keep_trajectory) TRY(keep_trajectory(run));
  fem_system_scatter(&run->system, 0, run->u, run->v);
  FemMeasures measures;
  TRY(fem_recorder_measure(&run->recorder, 0, &measures));
  fem_audit_begin(&run->audit, 0, &measures.energy, energy_floor(model));
  keep_extremes(run->result, &measures);
  fem_trouble_add(&run->result->trouble, 0, &measures.trouble);
  return write_frame(run, 0, &measures);
}

static Status begin(Run *run) {
  if (isfinite(fem_model_next_release(run->model, 0))) {
    TRY(fem_model_copy_numbering(&run->own, run->model));
    run->model = &run->own;
  }
  const FemModel *model = run->model;
  const FemSceneDef *scene = model->scene;
  TRY(allocate_states(run));
  TRY(fem_system_create(&run->system, model));
  for (int i = 0; i < model->unknown_count; i++) {
    int dof = model->dof_of_unknown[i];
    run->v[i] = model->initial_velocity[dof];
    if (run->options->initial_displacement) run->u[i] = run->options->initial_displacement[dof];
  }
  // What effects keep, they chose at rest.
  if (run->options->initial_displacement) TRY(fem_system_accept(&run->system, 0, run->u, run->v, 0));
  TRY(begin_stage(run, scene->initial_step));
  return begin_record(run);
}

// One step of load, halved where there is no equilibrium; `*step` is what to try next.
static Status advance_static(Run *run, double target, double *step) {
  double to = fmin(run->time + *step, target), work_before = run->statics.driven_work;
  Status status = fem_statics_step(&run->statics, run->time, to, run->u);
  if (status == STATUS_RETRY) {
    *step = 0.5 * (to - run->time);
    bool is_too_short = *step < SHORTEST_LOAD_STEP * run->model->scene->end / run->model->scene->frames;
    return is_too_short ? status_fail(STATUS_SOLVER, "%s", status_message()) : STATUS_OK;
  }
  TRY(status);
  run->time = to;
  *step *= 2;
  FemMeasures measures;
  run->audit.driven_work += run->statics.driven_work - work_before;
  fem_equilibrium_scatter(&run->statics.equilibrium, run->time, run->u);
  TRY(fem_recorder_measure(&run->recorder, run->time, &measures));
  FemAudit next = fem_audit_next(&run->audit, run->time, &measures.energy);
  run->audit = next;
  keep_extremes(run->result, &measures);
  run->before.steps = run->statics.steps;
  run->before.newton_iterations = run->statics.newton_iterations;
  if (run->time >= target) TRY(write_frame(run, run->time, &measures));
  return observe(run, &measures);
}

// From equilibrium to equilibrium, frame by frame.
static Status march_static(Run *run) {
  const FemSceneDef *scene = run->model->scene;
  FemSolverKind kind = fem_run_solver(run->model);
  run->result->solver_name = fem_solver_name(kind);
  TRY(allocate_states(run));
  TRY(fem_system_create(&run->system, run->model));
  TRY(fem_statics_create(&run->statics, &run->system, fem_solver_ops(kind)));
  if (run->options->initial_displacement)
    for (int i = 0; i < run->model->unknown_count; i++)
      run->u[i] = run->options->initial_displacement[run->model->dof_of_unknown[i]];
  TRY(begin_record(run));
  double step = scene->max_step > 0 ? scene->max_step : scene->end / scene->frames;
  while (run->next_frame <= scene->frames) {
    step = fmin(step, scene->max_step > 0 ? scene->max_step : scene->end / scene->frames);
    TRY(advance_static(run, frame_time(run, run->next_frame), &step));
  }
  return STATUS_OK;
}

static Status march(Run *run) {
  if (run->model->scene->is_static) return march_static(run);
  TRY(begin(run));
  while (run->time < run->model->scene->end) {
    if (run->time >= run->stage_end) TRY(release(run));
    TRY(advance(run));
  }
  return STATUS_OK;
}

static void sum_phases(Run *run) {
  FemRunPhases *phases = &run->result->phases;
  const FemSystem *system = &run->system;
  void *contact = fem_system_effect(system, "contact");
  for (int i = 0; i < system->effect_count; i++) {
    if (system->effects[i].self != contact) phases->forces += system->costs[i].force_s;
    phases->assembly += system->costs[i].jacobian_s;
    phases->contact += system->costs[i].prepare_s; // the broad phase is taken off below
  }
  if (contact) {
    const ContactCounters *counters = contact_system_counters(fem_effect_contact_system(contact));
    phases->broad_phase = counters->broad_s;
    phases->overlap = counters->overlap_s;
    phases->contact += counters->force_s - counters->broad_s;
    run->result->pairs = counters->pairs;
  }
  phases->analysis = run->result->solver.analyse_s;
  phases->factorisation = run->result->solver.factorise_s;
  phases->solve = run->result->solver.solve_s;
  phases->output = run->recorder.seconds;
}

static Status collect(Run *run) {
  FemRunResult *result = run->result;
  result->audit = run->audit;
  result->end_time = run->time;
  result->peak_rss_bytes = memory_peak_bytes();
  if (run->integrator) {
    result->integrator = stats_of(run);
    result->solver = solver_stats_of(run);
  } else if (run->statics.equilibrium.solver) {
    const FemEquilibrium *equilibrium = &run->statics.equilibrium;
    result->integrator = stats_of(run);
    result->solver = *equilibrium->ops->stats(equilibrium->solver);
    result->is_static = true;
    result->residual = run->statics.residual;
    result->residual_allowed = run->statics.tolerance * run->statics.force_scale;
    result->relaxation_steps = run->statics.relaxation_steps;
    result->halvings = run->statics.halvings;
  }
  result->state_unknowns = (result->is_static ? 1 : 2) * run->model->unknown_count;
  result->pattern_layouts = run->system.pattern_version;
  for (int i = 0; i < run->system.effect_count; i++)
    if (run->system.costs[i].jacobian_calls > result->assemblies)
      result->assemblies = run->system.costs[i].jacobian_calls;
  sum_phases(run);
  result->counters = record_new();
  result->effect_count = run->system.effect_count;
  for (int i = 0; i < run->system.effect_count; i++) {
    result->effects[i].name = run->system.effects[i].ops->name;
    result->effects[i].cost = run->system.costs[i];
  }
  for (int i = 0; i < run->system.effect_count; i++)
    if (run->system.effects[i].ops->report)
      run->system.effects[i].ops->report(run->system.effects[i].self, result->counters);
  return run->recorder.system ? fem_recorder_finish(&run->recorder) : STATUS_OK;
}

Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result) {
  *result = (FemRunResult){.min_det_F = INFINITY, .trouble = fem_trouble_begin(model)};
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  Run run = {.model = model, .options = options, .result = result};
  Status status = march(&run);
  if (status == STATUS_RETRY)
    status = status_fail(STATUS_SOLVER, "at t = %g s: %s", run.time, status_message());
  Status collected = collect(&run);
  result->wall_s = result->phases.total = clock_wall_s() - wall;
  result->cpu_s = clock_cpu_s() - cpu;
  fem_recorder_destroy(&run.recorder);
  fem_integrator_destroy(run.integrator);
  fem_statics_destroy(&run.statics);
  fem_system_destroy(&run.system);
  double *states[] = {run.u, run.v, run.u_new, run.v_new};
  for (int i = 0; i < 4; i++) memory_free(states[i]);
  fem_model_destroy_copy(&run.own);
  return status ? status : collected;
}
