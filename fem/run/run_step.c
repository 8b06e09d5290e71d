// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_step.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "fem/effect/system_energy.h"
#include "fem/run/result/run_clock.h"
#include "fem/run/run_frames.h"
#include "fem/run/run_stage.h"
#include "fem/run/run_watch.h"
#include "fem/time/verdict.h"

// A step that is proposed; its state is in u_new, v_new.
typedef struct Proposal {
  double time; // where it leads to [s]
  bool is_evaluated;
  FemMeasures measures;
  FemAudit audit; // as it would be
} Proposal;

// Whether forces are held to the motion. Without contact nothing jumps within a step; the force of the
// potential `nodal` does in steps however short, where a pair's ∇V is one-sided.
static bool has_momentum_bound(const FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  return scene->contact.is_on && scene->contact.potential == CONTACT_POTENTIAL_FIELD;
}

// Steps, and measures the state that the step leads to. RETRY: too far for the contact lists, or no numbers.
static Status step(FemRunState *run, Proposal *proposal) {
  FemRunSpan span = fem_run_clock_begin(run);
  Status status = fem_integrator_step(run->integrator, &proposal->time);
  fem_run_clock_end(run, span, &run->result->cost.phases.integration);
  TRY(status);
  const double *u, *v;
  TRY(fem_integrator_at(run->integrator, proposal->time, &u, &v));
  size_t bytes = (size_t)run->system.numbering.count * sizeof(double);
  memcpy(run->u_new, u, bytes);
  memcpy(run->v_new, v, bytes);
  fem_system_scatter(&run->system, proposal->time, run->u_new, run->v_new, &run->trial);
  TRY(fem_run_frames_measure(run, &proposal->measures));
  return fem_recorder_end_step(&run->recorder, &run->trial, &proposal->measures);
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
  if (!status) *power = energy.dissipated_power - at_end + at_middle;
  return status;
}

// The audit of the step.
static Status audit(FemRunState *run, Proposal *proposal) {
  const FemEnergy *energy = &proposal->measures.energy;
  double time = proposal->time;
  proposal->audit = fem_audit_next(&run->audit, time, energy);
  run->least_power = INFINITY;
  bool is_doubtful = fem_audit_is_doubtful(&run->result->energy.bounds, &run->audit, &proposal->audit);
  if (!is_doubtful || !(energy->dissipated_power > 0)) return STATUS_OK;
  TRY(find_least_power(run, time, &run->least_power));
  proposal->audit = fem_audit_next_within(&run->audit, time, energy, run->least_power);
  return STATUS_OK;
}

// Forces that cannot be evaluated are no failure of the proposal but a finding.
static Status note(Proposal *proposal, Status status) {
  proposal->is_evaluated = status != STATUS_RETRY;
  return proposal->is_evaluated ? status : STATUS_OK;
}

static Status propose(FemRunState *run, Proposal *proposal) {
  *proposal = (Proposal){.time = run->time};
  const FemMomentum *momentum = &run->recorder.ledger.momentum;
  double end = run->model->scene->end,
         strictness = has_momentum_bound(run) ? fem_momentum_strictness(momentum, end) : 1;
  fem_integrator_tighten(run->integrator, strictness, momentum->groups);
  Status status = step(run, proposal);
  if (!status) status = audit(run, proposal);
  return note(proposal, status);
}

static FemVerdict judge(const FemRunState *run, const Proposal *proposal) {
  FemFindings findings = {.length = fem_integrator_stats(run->integrator).last_step,
                          .shortest = fem_integrator_shortest_step(run->integrator),
                          .resolved = fem_run_stage_resolved(run->model),
                          .rebound = run->rebound,
                          .is_evaluated = proposal->is_evaluated};
  if (!proposal->is_evaluated) return fem_verdict_of(&findings);
  findings.gains_energy = fem_audit_is_refused(&run->result->energy.bounds, &run->audit, &proposal->audit);
  findings.differs_from_motion =
      has_momentum_bound(run) &&
      fem_momentum_is_refused(&run->recorder.ledger.momentum, run->model->scene->end);
  findings.reversed =
      proposal->measures.energy.turned_power * (proposal->time - run->time) / run->audit.scale;
  return fem_verdict_of(&findings);
}

// The step's row of the history, and the frames within it.
static Status show(FemRunState *run, Proposal *proposal) {
  Status status = fem_run_frames_take_row(run, &proposal->measures, &proposal->audit);
  if (!status) status = fem_run_frames_write_until(run, proposal->time);
  return note(proposal, status);
}

static void count_retry(FemRunResult *result, FemCause cause) {
  result->retries.energy += cause == FEM_CAUSE_ENERGY;
  result->retries.momentum += cause == FEM_CAUSE_MOMENTUM;
  result->retries.slip += cause == FEM_CAUSE_REVERSAL;
}

// Back to the last accepted state with a smaller step.
static Status try_again(FemRunState *run, const Proposal *proposal, const FemVerdict *verdict) {
  bool has_message = verdict->cause == FEM_CAUSE_FORCES;
  if (verdict->step == 0) return STATUS_RETRY; // the message says why
  log_debug("t = %.9g s: a step of %.3g s is taken back: %s", run->time,
            fem_integrator_stats(run->integrator).last_step,
            has_message ? status_message() : fem_verdict_words(verdict->cause));
  count_retry(run->result, verdict->cause);
  if (verdict->cause == FEM_CAUSE_ENERGY) fem_audit_refuse(&run->audit, &proposal->audit);
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, verdict->step);
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

static void keep_state(FemRunState *run, double time) {
  double *u = run->u, *v = run->v;
  run->u = run->u_new, run->v = run->v_new;
  run->u_new = u, run->v_new = v;
  run->time = time;
  fem_recorder_accept_step(&run->recorder);
}

static Status commit(FemRunState *run, Proposal *proposal) {
  TRY(fem_recorder_append_step(&run->recorder));
  fem_audit_accept(&run->audit, &proposal->audit);
  keep_state(run, proposal->time);
  fem_run_frames_keep_extremes(run->result, &proposal->measures);
  FemIntegratorStats stats = fem_run_state_stats(run);
  run->result->trouble.smallest_step = fmin(run->result->trouble.smallest_step, stats.last_step);
  TRY(fem_run_stage_accept(run, stats.current_step));
  if (fem_integrator_is_at_knot(run->integrator)) TRY(renew_powers(run));
  TRY(fem_run_watch(run, &proposal->measures));
  return fem_rest_has_changed(run->rest) ? fem_run_stage_change(run) : STATUS_OK;
}

static Status advance(FemRunState *run) {
  Proposal proposal;
  TRY(propose(run, &proposal));
  FemVerdict verdict = judge(run, &proposal);
  if (verdict.stands) {
    TRY(fem_run_watch_refuse(run, proposal.time, &proposal.measures.trouble));
    TRY(show(run, &proposal));
    if (!proposal.is_evaluated) verdict = judge(run, &proposal);
  }
  return verdict.stands ? commit(run, &proposal) : try_again(run, &proposal, &verdict);
}

Status fem_run_step_advance(FemRunState *run) {
  FemRunSpan span = fem_run_clock_begin(run);
  Status status = advance(run);
  fem_run_clock_end(run, span, &run->result->cost.phases.measures);
  return status;
}
