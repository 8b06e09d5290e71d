// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/integrator.h"

#include <float.h>
#include <ida/ida.h>
#include <math.h>
#include <stdio.h>

#include "base/memory.h"
#include "fem/model/limits.h"
#include "fem/time/ida/memory.h"
#include "fem/time/ida/start.h"
#include "fem/time/reason.h"
#include "fem/time/stop.h"

struct FemIntegrator {
  FemIda ida;
  FemIntegratorDef def;
  double min_step, max_step;  // [s]
  double time;                // of the state that the last step or restart ended at
  bool is_started, has_steps; // there was a restart; a step since then
  double target;              // nor any step until the caller sets another one [s]
  double stop;                // which the next step does not pass [s]
  bool stops_at_knot;         // that is why
  bool is_at_knot;            // the last step ended there
  double wanted_step;         // handed to the last restart [s]
  FemIntegratorStats before;  // counted before the last restart
  long long restart_count;
  FemStall own_stall;         // where the caller has none
  long long failures_counted; // that the stall has counted
};

// ---- Creation.

static Status check_def(const FemIntegratorDef *def) {
  if (!(def->displacement_tolerance > 0) || !(def->velocity_tolerance > 0) ||
      isinf(def->displacement_tolerance) || isinf(def->velocity_tolerance))
    return status_fail(STATUS_INPUT, "the time tolerances must be positive numbers, not %g m and %g m/s",
                       def->displacement_tolerance, def->velocity_tolerance);
  if (!(def->end > 0) || isinf(def->end))
    return status_fail(STATUS_INPUT, "time.end must be a positive number, not %g s", def->end);
  if (!(def->initial_step >= 0) || !(def->min_step >= 0) || !(def->max_step >= 0))
    return status_fail(STATUS_INPUT, "time steps must not be negative");
  if (def->max_step > 0 && def->min_step > def->max_step)
    return status_fail(STATUS_INPUT, "time.min_step (%g s) is longer than time.max_step (%g s)",
                       def->min_step, def->max_step);
  if (def->max_order != 1 && def->max_order != 2)
    return status_fail(STATUS_INPUT, "time.max_order must be 1 or 2, not %d", def->max_order);
  return STATUS_OK;
}

static Status create(FemIntegrator *integrator, FemSystem *system, FemState *state,
                     const FemSolverOps *solver) {
  const FemIntegratorDef *def = &integrator->def;
  TRY(check_def(def));
  integrator->max_step = def->max_step > 0 ? def->max_step : fmax(FEM_LONGEST_STEP * def->end, def->min_step);
  integrator->min_step =
      def->min_step > 0 ? def->min_step : fmin(FEM_TIME_RESOLUTION * def->end, integrator->max_step);
  FemIdaDef ida = {.system = system,
                   .state = state,
                   .solver = solver,
                   .tolerance = {.displacement = def->displacement_tolerance,
                                 .velocity = def->velocity_tolerance,
                                 .speed_share = def->speed_share},
                   .max_order = def->max_order,
                   .min_step = integrator->min_step,
                   .max_step = integrator->max_step};
  return fem_ida_memory_create(&integrator->ida, &ida);
}

Status fem_integrator_create(FemIntegrator **integrator, FemSystem *system, FemState *state,
                             const FemSolverOps *solver, const FemIntegratorDef *def) {
  *integrator = memory_zeroed(1, sizeof **integrator);
  if (!*integrator) return status_no_memory("the integrator");
  (*integrator)->def = *def;
  (*integrator)->target = INFINITY;
  (*integrator)->own_stall = fem_stall_begin(0, def->end, def->end);
  Status status = create(*integrator, system, state, solver);
  if (status == STATUS_OK) return STATUS_OK;
  fem_integrator_destroy(*integrator);
  *integrator = NULL;
  return status;
}

void fem_integrator_destroy(FemIntegrator *integrator) {
  if (!integrator) return;
  fem_ida_memory_destroy(&integrator->ida);
  memory_free(integrator);
}

double fem_integrator_shortest_step(const FemIntegrator *integrator) {
  return integrator->min_step;
}

void fem_integrator_aim(FemIntegrator *integrator, double target) {
  integrator->target = target;
}

void fem_integrator_tighten(FemIntegrator *integrator, double share, const int *groups) {
  integrator->ida.strictness = share;
  integrator->ida.groups = groups;
}

static FemStall *stall_of(FemIntegrator *integrator) {
  return integrator->def.stall ? integrator->def.stall : &integrator->own_stall;
}

// ---- Start.

Status fem_integrator_restart(FemIntegrator *integrator, double time, const double *u, const double *v,
                              double step) {
  FemIda *ida = &integrator->ida;
  double *y = fem_ida_values(ida->y);
  FemIntegratorStats stats = fem_integrator_stats(integrator);
  fem_part_take(&ida->part, u, y);
  fem_part_take(&ida->part, v, y + ida->n);
  TRY(fem_ida_start_derivatives(ida, time));
  if (step == 0 && !integrator->is_started) step = integrator->def.initial_step;
  if (step == 0) step = fem_ida_start_step(ida, time, integrator->def.end, integrator->def.least_start);
  if (step > 0) step = fmin(fmax(step, integrator->min_step), integrator->max_step);
  bool is_ok = IDAReInit(ida->memory, time, ida->y, ida->y_dot) == IDA_SUCCESS &&
               IDASetInitStep(ida->memory, step) == IDA_SUCCESS;
  if (!is_ok) return status_fail(STATUS_SOLVER, "IDA could not be restarted at t = %g s", time);
  if (integrator->has_steps && time < integrator->time) { // back over the last step
    fem_stall_take_back(stall_of(integrator));
    stats.steps--;
  }
  integrator->before = stats;
  integrator->restart_count += integrator->is_started;
  integrator->time = time;
  integrator->is_started = true;
  integrator->has_steps = integrator->is_at_knot = false;
  integrator->wanted_step = step;
  return STATUS_OK;
}

// ---- The solution within a step.

// The solution at `time` in `interpolated`.
static Status interpolate(FemIntegrator *integrator, double time) {
  if (integrator->is_started && time == integrator->time) { // to the last bit
    N_VScale(1, integrator->ida.y, integrator->ida.interpolated);
    return STATUS_OK;
  }
  if (!integrator->has_steps ||
      IDAGetDky(integrator->ida.memory, time, 0, integrator->ida.interpolated) != IDA_SUCCESS)
    return status_fail(STATUS_SOLVER,
                       "the solution at t = %.17g s was asked for, which is not in the step to %.17g s", time,
                       integrator->time);
  return STATUS_OK;
}

Status fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v) {
  TRY(interpolate(integrator, time));
  *u = fem_part_join(&integrator->ida.part, fem_ida_values(integrator->ida.interpolated));
  *v = *u + integrator->ida.part.n;
  return STATUS_OK;
}

// ---- Failures.

// The number in y of the unknown that is to blame for the flag.
static int find_worst(FemIntegrator *integrator, int flag) {
  return fem_ida_failure_worst(integrator->ida.memory, flag, &integrator->ida.part,
                               integrator->ida.interpolated, integrator->ida.weights);
}

static Status say_why(const FemIntegrator *integrator, double time, double step, int worst,
                      FemReason reason) {
  FemReasonPlace place = {.time = time,
                          .step = step,
                          .positions = integrator->ida.state->positions,
                          .velocities = integrator->ida.state->velocities,
                          .unknown = worst % integrator->ida.part.n,
                          .is_position = worst < integrator->ida.part.n,
                          .retry = integrator->ida.failure.retry_message};
  return fem_reason_fail(&reason, integrator->ida.system, &place);
}

static Status give_up(FemIntegrator *integrator, int flag) {
  const FemIdaFailure *failure = &integrator->ida.failure;
  if (failure->fatal != STATUS_OK)
    return status_fail(failure->fatal, "at t = %.9g s: %s", integrator->time, failure->fatal_message);
  if (flag == IDA_MEM_FAIL) return status_no_memory("the integrator");
  double time = integrator->time, step = 0;
  IDAGetCurrentTime(integrator->ida.memory, &time);
  IDAGetCurrentStep(integrator->ida.memory, &step);
  return say_why(integrator, time, step, find_worst(integrator, flag), fem_ida_failure_reason(flag));
}

// Counts the step, and the tries that failed before it.
static Status check_stall(FemIntegrator *integrator) {
  FemIntegratorStats stats = fem_integrator_stats(integrator);
  long long failures = stats.error_test_failures + stats.newton_failures,
            more = failures - integrator->failures_counted;
  integrator->failures_counted = failures;
  FemStall *stall = stall_of(integrator);
  FemStallVerdict verdict = fem_stall_add(stall, 1 + more, more, integrator->time, integrator->max_step);
  if (verdict == FEM_STALL_GOES_ON) return STATUS_OK;
  char what[128];
  snprintf(what, sizeof what,
           "the run %s: at the pace of the last %d steps the rest of it would take %.2g more",
           verdict == FEM_STALL_STANDS ? "stalls" : "creeps", FEM_STALL_WINDOW, stall->left);
  FemReason reason = {
      what, "a smaller contact.stiffness, another contact.overlap where the model's force jumps, as that of "
            "tpn does, or some effects.damping"};
  return say_why(integrator, integrator->time, stats.last_step, find_worst(integrator, IDA_ERR_FAIL), reason);
}

// ---- Steps.

// The next step ends at def.end at the latest, or just before the knot that what is prescribed has to be
// followed to.
static Status choose_stop(FemIntegrator *integrator) {
  const FemIntegratorDef *def = &integrator->def;
  FemStopDef wish = {.system = integrator->ida.system,
                     .begin = integrator->time,
                     .end = fmin(def->end, integrator->target),
                     .planned = integrator->max_step,
                     .max_step = integrator->max_step,
                     .may_halve = integrator->has_steps,
                     .displacement = def->displacement_tolerance,
                     .velocity = def->velocity_tolerance,
                     .least = fmax(integrator->min_step, FEM_TIME_RESOLUTION * def->end)};
  if (integrator->has_steps) IDAGetCurrentStep(integrator->ida.memory, &wish.planned);
  FemStop stop = fem_stop_choose(&wish);
  integrator->stop = stop.time;
  integrator->stops_at_knot = stop.is_knot;
  IDASetMaxStep(integrator->ida.memory, stop.longest);
  if (IDASetStopTime(integrator->ida.memory, stop.time) == IDA_SUCCESS) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "IDA cannot stop at t = %.17g s from t = %.17g s", stop.time, wish.begin);
}

// After a knot whose successor is nearer than the last step was long, that step cannot predict the next one:
// the method begins anew.
static Status pass_knot(FemIntegrator *integrator) {
  double last = fem_integrator_stats(integrator).last_step;
  if (!integrator->stops_at_knot || integrator->stop - integrator->time >= last) return STATUS_OK;
  const double *u = fem_part_join(&integrator->ida.part, fem_ida_values(integrator->ida.y));
  double past = fem_signal_past(integrator->time);
  TRY(fem_integrator_restart(integrator, past, u, u + integrator->ida.part.n, 0));
  return choose_stop(integrator);
}

// IDA computes the step's end from its differences. Where that is the state whose forces were evaluated last,
// but for rounding, the values of the evaluation are used, so that nothing is evaluated twice.
static void use_evaluated(FemIda *ida, double reached) {
  if (ida->evaluated_time != reached) return;
  N_Vector difference = ida->interpolated;
  N_VLinearSum(1, ida->evaluated, -1, ida->y, difference);
  if (IDAGetErrWeights(ida->memory, ida->weights) != IDA_SUCCESS) return;
  N_VProd(difference, ida->weights, difference);
  if (fem_part_most(N_VMaxNorm(difference)) <= FEM_ROUNDING) N_VScale(1, ida->evaluated, ida->y);
}

static Status step_ida(FemIntegrator *integrator) {
  FemIda *ida = &integrator->ida;
  double reached;
  TRY(choose_stop(integrator));
  if (fem_integrator_is_at_knot(integrator)) TRY(pass_knot(integrator));
  ida->failure.retry_message[0] = 0;
  int flag = IDASolve(ida->memory, integrator->def.end, &reached, ida->y, ida->y_dot, IDA_ONE_STEP);
  if (flag < 0) return give_up(integrator, flag);
  use_evaluated(ida, reached);
  fem_balance_keep(&ida->balance, ida->system->model, reached - integrator->time);
  integrator->time = reached;
  integrator->has_steps = true;
  integrator->is_at_knot = integrator->stops_at_knot && reached == integrator->stop;
  return STATUS_OK;
}

Status fem_integrator_step(FemIntegrator *integrator, double *time) {
  *time = integrator->time;
  if (!integrator->is_started || integrator->ida.failure.fatal != STATUS_OK)
    return status_fail(STATUS_SOLVER, "a step was asked for before a start or after a fatal failure");
  double begin = integrator->time, end = integrator->def.end;
  if (end - begin <= 4 * DBL_EPSILON * end) { // nothing that a step could resolve
    *time = integrator->time = end;
    return STATUS_OK;
  }
  TRY(step_ida(integrator));
  *time = integrator->time;
  return check_stall(integrator);
}

bool fem_integrator_is_at_knot(const FemIntegrator *integrator) {
  return integrator->is_at_knot;
}

// ---- Counts.

FemIntegratorStats fem_integrator_stats(const FemIntegrator *integrator) {
  FemIntegratorStats stats = integrator->before;
  stats.restarts = integrator->restart_count;
  stats.current_step = integrator->wanted_step;
  long steps = 0, residuals = 0, setups = 0, error_failures = 0, iterations = 0, failures = 0;
  if (!integrator->is_started) return stats;
  void *ida = integrator->ida.memory;
  IDAGetNumSteps(ida, &steps);
  IDAGetNumResEvals(ida, &residuals);
  IDAGetNumLinSolvSetups(ida, &setups);
  IDAGetNumErrTestFails(ida, &error_failures);
  IDAGetNumNonlinSolvIters(ida, &iterations);
  IDAGetNumStepSolveFails(ida, &failures);
  stats.steps += steps, stats.residuals += residuals, stats.setups += setups;
  stats.error_test_failures += error_failures, stats.newton_iterations += iterations;
  stats.newton_failures += failures;
  if (!integrator->has_steps) return stats;
  IDAGetLastStep(ida, &stats.last_step);
  IDAGetCurrentStep(ida, &stats.current_step);
  IDAGetLastOrder(ida, &stats.last_order);
  return stats;
}

const FemSolverStats *fem_integrator_solver_stats(const FemIntegrator *integrator) {
  return fem_ida_solver_stats(integrator->ida.solver);
}

double fem_integrator_product_s(const FemIntegrator *integrator) {
  return fem_ida_solver_product_s(integrator->ida.solver);
}
