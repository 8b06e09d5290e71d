// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/integrator.h"

#include <float.h>
#include <ida/ida.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/limits.h"
#include "fem/sparse/vector.h"
#include "fem/time/error_weights.h"
#include "fem/time/newton/balance.h"
#include "fem/time/newton/ida_failure.h"
#include "fem/time/newton/ida_solver.h"
#include "fem/time/newton/newton.h"
#include "fem/time/nvector.h"
#include "fem/time/reason.h"
#include "fem/time/stop.h"
#include "fem/time/sundials.h"

// Without contact a step is lengthened only if it can double (IDA's own), which saves factorisations.
static const double LEAST_GROWTH_WITHOUT_CONTACT = 2;

struct FemIntegrator {
  FemSystem *system; // borrowed
  FemState *state;   // the one that was evaluated last, borrowed
  FemIntegratorDef def;
  double min_step, max_step; // [s]
  FemPart part;
  int n; // this rank's unknowns; y and ẏ have 2n
  SUNContext context;
  void *ida;
  FemIdaSolver *solver;
  FemIdaFailure failure;
  FemNewton newton;
  FemBalance balance;
  N_Vector y, y_dot;     // state that the last step or restart ended at
  N_Vector interpolated; // what `at` returns; scratch
  N_Vector evaluated;    // of the last residual
  double evaluated_time;
  N_Vector weights;           // scratch: of the error test
  double time;                // of y
  bool is_started, has_steps; // there was a restart; a step since then
  double strictness;          // share of the tolerances of velocities that counts
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

static double *values_of(N_Vector vector) {
  return N_VGetArrayPointer(vector);
}

// To all vertices, of all ranks.
static void scatter(FemIntegrator *integrator, double time, N_Vector y) {
  const double *u = fem_part_join(&integrator->part, values_of(y));
  fem_system_scatter(integrator->system, time, u, u + integrator->part.n, integrator->state);
}

// ---- What IDA and Newton's method ask for.

// r = [u̇ − v; M v̇ − f(u, v, t)]
static int residual(sunrealtype time, N_Vector y, N_Vector y_dot, N_Vector r, void *self) {
  FemIntegrator *integrator = self;
  FemSystem *system = integrator->system;
  const FemPart *part = &integrator->part;
  int n = integrator->n;
  const double *v = values_of(y) + n, *u_dot = values_of(y_dot), *v_dot = u_dot + n;
  const double *masses = fem_ida_solver_masses(integrator->solver);
  double *kinematics = values_of(r), *balance = kinematics + n;
  N_VScale(1, y, integrator->evaluated);
  integrator->evaluated_time = time;
  scatter(integrator, time, y);
  int answer = fem_ida_failure_answer(&integrator->failure, fem_system_forces(system, integrator->state));
  if (answer != 0) return answer;
#pragma omp parallel for schedule(static) if (n > FEM_VECTOR_LONG)
  for (int i = 0; i < n; i++) {
    kinematics[i] = u_dot[i] - v[i];
    balance[i] = masses[i] * v_dot[i] - system->forces[fem_part_dof(part, i)];
  }
  return 0;
}

static int jacobian(sunrealtype time, sunrealtype c, N_Vector y, N_Vector y_dot, N_Vector r, SUNMatrix matrix,
                    void *self, N_Vector scratch1, N_Vector scratch2, N_Vector scratch3) {
  (void)y_dot, (void)r, (void)matrix, (void)scratch1, (void)scratch2, (void)scratch3;
  FemIntegrator *integrator = self;
  scatter(integrator, time, y);
  Status status = fem_ida_solver_assemble(integrator->solver, integrator->state, c);
  return fem_ida_failure_answer(&integrator->failure, status);
}

// IDA asks before every step.
static int find_weights(N_Vector y, N_Vector weights, void *self) {
  const FemIntegrator *integrator = self;
  const FemIntegratorDef *def = &integrator->def;
  FemErrorTolerance tolerance = {.displacement = def->displacement_tolerance,
                                 .velocity = integrator->strictness * def->velocity_tolerance,
                                 .speed_share = integrator->strictness * def->speed_share};
  fem_error_weights(&tolerance, integrator->system->model, &integrator->part, values_of(y) + integrator->n,
                    values_of(weights));
  return 0;
}

static const double *right_of(void *self) {
  return fem_ida_solver_right(((FemIntegrator *)self)->solver);
}

static void aim(void *self, double tolerance) {
  FemIntegrator *integrator = self;
  double c = 0;
  IDAGetCurrentCj(integrator->ida, &c);
  fem_ida_solver_aim(integrator->solver, c, tolerance);
}

static double unbalance(void *self, const double *balance) {
  FemIntegrator *integrator = self;
  const ContactEvaluation *contact;
  if (fem_effect_contact_evaluate(integrator->system, integrator->state, &contact)) return INFINITY;
  const FemSystem *system = integrator->system;
  return fem_balance_excess(&integrator->balance, system->model, &integrator->part, system->forces,
                            contact ? contact->given_forces : NULL, balance);
}

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

static Status create_vectors(FemIntegrator *integrator) {
  TRY(fem_part_create(&integrator->part, integrator->system->model, &integrator->system->numbering));
  integrator->n = integrator->part.count;
  if (!fem_sundials_create(&integrator->context)) return status_no_memory("the integrator");
  N_Vector *vectors[] = {&integrator->y, &integrator->y_dot, &integrator->interpolated,
                         &integrator->evaluated, &integrator->weights};
  for (int i = 0; i < 5; i++) {
    *vectors[i] = fem_nvector_create(2 * integrator->n, integrator->context); // IDA's own ones are clones
    if (!*vectors[i]) return status_no_memory("the integrator");
  }
  return STATUS_OK;
}

// After so many failures in a row the longest step has become the shortest: from the third on each cuts it to
// a quarter at least.
static int most_failures(const FemIntegrator *integrator) {
  return 2 + (int)ceil(0.5 * log2(integrator->max_step / integrator->min_step));
}

static Status configure(FemIntegrator *integrator) {
  void *ida = integrator->ida = IDACreate(integrator->context);
  if (!ida) return status_no_memory("the integrator");
  FemIdaSolver *solver = integrator->solver;
  bool has_contact = fem_system_effect(integrator->system, &fem_effect_contact);
  int failures = most_failures(integrator);
  double least_growth = has_contact ? FEM_LEAST_GROWTH : LEAST_GROWTH_WITHOUT_CONTACT;
  bool is_ok =
      FEM_SUNDIALS_SILENCE(IDA, ida) &&
      IDASetMaxOrd(ida, integrator->def.max_order) == IDA_SUCCESS && // before vectors are made for more
      IDAInit(ida, residual, 0, integrator->y, integrator->y_dot) == IDA_SUCCESS &&
      IDAWFtolerances(ida, find_weights) == IDA_SUCCESS && IDASetUserData(ida, integrator) == IDA_SUCCESS &&
      fem_ida_solver_attach(solver, ida) && IDASetJacFn(ida, jacobian) == IDA_SUCCESS &&
      IDASetNonlinearSolver(ida, integrator->newton.solver) == IDA_SUCCESS &&
      IDASetMaxStep(ida, integrator->max_step) == IDA_SUCCESS &&
      IDASetMinStep(ida, integrator->min_step) == IDA_SUCCESS &&
      IDASetEtaFixedStepBounds(ida, 1, least_growth) == IDA_SUCCESS &&
      IDASetMaxErrTestFails(ida, failures) == IDA_SUCCESS &&
      IDASetMaxConvFails(ida, failures) == IDA_SUCCESS && IDASetMaxNumSteps(ida, -1) == IDA_SUCCESS;
  return is_ok ? STATUS_OK : status_fail(STATUS_SOLVER, "IDA could not be set up");
}

static Status create(FemIntegrator *integrator, const FemSolverOps *solver) {
  const FemIntegratorDef *def = &integrator->def;
  TRY(check_def(def));
  integrator->max_step = def->max_step > 0 ? def->max_step : fmax(FEM_LONGEST_STEP * def->end, def->min_step);
  integrator->min_step =
      def->min_step > 0 ? def->min_step : fmin(FEM_TIME_RESOLUTION * def->end, integrator->max_step);
  TRY(create_vectors(integrator));
  TRY(fem_ida_solver_create(&integrator->solver, integrator->system, &integrator->part, solver,
                            FEM_ROUNDING * def->velocity_tolerance, &integrator->failure,
                            integrator->context));
  TRY(fem_balance_create(&integrator->balance, integrator->system->model->body_count));
  FemNewtonUser user = {
      .self = integrator, .n = integrator->n, .right = right_of, .unbalance = unbalance, .aim = aim};
  TRY(fem_newton_create(&integrator->newton, &user, integrator->y, integrator->context));
  return configure(integrator);
}

Status fem_integrator_create(FemIntegrator **integrator, FemSystem *system, FemState *state,
                             const FemSolverOps *solver, const FemIntegratorDef *def) {
  *integrator = memory_zeroed(1, sizeof **integrator);
  if (!*integrator) return status_no_memory("the integrator");
  (*integrator)->system = system;
  (*integrator)->state = state;
  (*integrator)->def = *def;
  (*integrator)->strictness = 1;
  (*integrator)->target = INFINITY;
  (*integrator)->own_stall = fem_stall_begin(0, def->end, def->end);
  Status status = create(*integrator, solver);
  if (status == STATUS_OK) return STATUS_OK;
  fem_integrator_destroy(*integrator);
  *integrator = NULL;
  return status;
}

void fem_integrator_destroy(FemIntegrator *integrator) {
  if (!integrator) return;
  if (integrator->ida) IDAFree(&integrator->ida);
  fem_newton_destroy(&integrator->newton);
  fem_balance_destroy(&integrator->balance);
  fem_part_destroy(&integrator->part);
  fem_ida_solver_destroy(integrator->solver);
  N_Vector vectors[] = {integrator->y, integrator->y_dot, integrator->interpolated, integrator->evaluated,
                        integrator->weights};
  for (int i = 0; i < 5; i++)
    if (vectors[i]) N_VDestroy(vectors[i]);
  if (integrator->context) SUNContext_Free(&integrator->context);
  memory_free(integrator);
}

double fem_integrator_shortest_step(const FemIntegrator *integrator) {
  return integrator->min_step;
}

void fem_integrator_aim(FemIntegrator *integrator, double target) {
  integrator->target = target;
}

void fem_integrator_tighten(FemIntegrator *integrator, double share) {
  integrator->strictness = share;
}

static FemStall *stall_of(FemIntegrator *integrator) {
  return integrator->def.stall ? integrator->def.stall : &integrator->own_stall;
}

// ---- Start.

// v̇ = M⁻¹ f at (t, y), and ẏ = [v; v̇].
static Status find_derivatives(FemIntegrator *integrator, double time) {
  FemSystem *system = integrator->system;
  const FemPart *part = &integrator->part;
  int n = integrator->n;
  const double *u = values_of(integrator->y), *v = u + n;
  const double *masses = fem_ida_solver_masses(integrator->solver);
  double *u_dot = values_of(integrator->y_dot), *v_dot = u_dot + n;
  if (ranks_any(!fem_vector_is_finite(2 * n, u)))
    return status_fail(STATUS_SOLVER, "at t = %g s: a position or velocity is not a number", time);
  scatter(integrator, time, integrator->y);
  TRY(fem_system_forces(system, integrator->state));
  for (int i = 0; i < n; i++) {
    u_dot[i] = v[i];
    v_dot[i] = system->forces[fem_part_dof(part, i)] / masses[i];
  }
  if (!ranks_any(!fem_vector_is_finite(n, v_dot))) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "at t = %g s: an acceleration is not a number", time);
}

// IDA's own first step: a thousandth of the way to the end, or what changes the state by half of the
// tolerances where that is shorter (SUNDIALS, IDASolve).
static const double START_SHARE = 1e-3, START_CHANGE = 0.5; // not chosen: IDA's own

// ‖ẏ‖ in the norm of the error test, without the velocity that nothing can notice.
static double rate_of_change(FemIntegrator *integrator, bool *has_common) {
  const FemModel *model = integrator->system->model;
  N_Vector rates = integrator->interpolated;
  double common[3];
  vec3_store(common,
             fem_error_weights_common(model, &integrator->part, values_of(integrator->y) + integrator->n));
  *has_common = vec3_length(vec3_at(common)) > 0;
  N_VScale(1, integrator->y_dot, rates);
  for (int i = 0; i < integrator->n && *has_common; i++)
    values_of(rates)[i] -= common[fem_part_dof(&integrator->part, i) % 3];
  find_weights(integrator->y, integrator->weights, integrator);
  return N_VWrmsNorm(rates, integrator->weights);
}

// The first step of a start that is left to IDA; 0: IDA's own will do, unless it would go by a velocity that
// nothing can notice. Where something is driven from rest with a jump of its speed, accelerations are large
// for a time in which nothing moves. They say nothing of how long a step may be; the error test does.
static double start_step(FemIntegrator *integrator, double time) {
  bool has_common;
  const double longest = START_SHARE * (integrator->def.end - time),
               least = fmin(integrator->def.least_start, longest),
               rate = rate_of_change(integrator, &has_common);
  if (least > 0 && rate * least > START_CHANGE) return least;
  if (!has_common) return 0;
  return rate * longest > START_CHANGE ? START_CHANGE / rate : longest;
}

Status fem_integrator_restart(FemIntegrator *integrator, double time, const double *u, const double *v,
                              double step) {
  double *y = values_of(integrator->y);
  FemIntegratorStats stats = fem_integrator_stats(integrator);
  fem_part_take(&integrator->part, u, y);
  fem_part_take(&integrator->part, v, y + integrator->n);
  TRY(find_derivatives(integrator, time));
  if (step == 0 && !integrator->is_started) step = integrator->def.initial_step;
  if (step == 0) step = start_step(integrator, time);
  if (step > 0) step = fmin(fmax(step, integrator->min_step), integrator->max_step);
  void *ida = integrator->ida;
  bool is_ok = IDAReInit(ida, time, integrator->y, integrator->y_dot) == IDA_SUCCESS &&
               IDASetInitStep(ida, step) == IDA_SUCCESS;
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
    N_VScale(1, integrator->y, integrator->interpolated);
    return STATUS_OK;
  }
  if (!integrator->has_steps || IDAGetDky(integrator->ida, time, 0, integrator->interpolated) != IDA_SUCCESS)
    return status_fail(STATUS_SOLVER,
                       "the solution at t = %.17g s was asked for, which is not in the step to %.17g s", time,
                       integrator->time);
  return STATUS_OK;
}

Status fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v) {
  TRY(interpolate(integrator, time));
  *u = fem_part_join(&integrator->part, values_of(integrator->interpolated));
  *v = *u + integrator->part.n;
  return STATUS_OK;
}

// ---- Failures.

// The number in y of the unknown that is to blame for the flag.
static int find_worst(FemIntegrator *integrator, int flag) {
  return fem_ida_failure_worst(integrator->ida, flag, &integrator->part, integrator->interpolated,
                               integrator->weights);
}

static Status say_why(const FemIntegrator *integrator, double time, double step, int worst,
                      FemReason reason) {
  FemReasonPlace place = {.time = time,
                          .step = step,
                          .positions = integrator->state->positions,
                          .unknown = worst % integrator->part.n,
                          .is_position = worst < integrator->part.n,
                          .retry = integrator->failure.retry_message};
  return fem_reason_fail(&reason, integrator->system, &place);
}

static Status give_up(FemIntegrator *integrator, int flag) {
  const FemIdaFailure *failure = &integrator->failure;
  if (failure->fatal != STATUS_OK)
    return status_fail(failure->fatal, "at t = %.9g s: %s", integrator->time, failure->fatal_message);
  if (flag == IDA_MEM_FAIL) return status_no_memory("the integrator");
  double time = integrator->time, step = 0;
  IDAGetCurrentTime(integrator->ida, &time);
  IDAGetCurrentStep(integrator->ida, &step);
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
  FemStopDef wish = {.system = integrator->system,
                     .begin = integrator->time,
                     .end = fmin(def->end, integrator->target),
                     .planned = integrator->max_step,
                     .max_step = integrator->max_step,
                     .may_halve = integrator->has_steps,
                     .displacement = def->displacement_tolerance,
                     .velocity = def->velocity_tolerance,
                     .least = fmax(integrator->min_step, FEM_TIME_RESOLUTION * def->end)};
  if (integrator->has_steps) IDAGetCurrentStep(integrator->ida, &wish.planned);
  FemStop stop = fem_stop_choose(&wish);
  integrator->stop = stop.time;
  integrator->stops_at_knot = stop.is_knot;
  IDASetMaxStep(integrator->ida, stop.longest);
  if (IDASetStopTime(integrator->ida, stop.time) == IDA_SUCCESS) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "IDA cannot stop at t = %.17g s from t = %.17g s", stop.time, wish.begin);
}

// After a knot whose successor is nearer than the last step was long, that step cannot predict the next one:
// the method begins anew.
static Status pass_knot(FemIntegrator *integrator) {
  double last = fem_integrator_stats(integrator).last_step;
  if (!integrator->stops_at_knot || integrator->stop - integrator->time >= last) return STATUS_OK;
  const double *u = fem_part_join(&integrator->part, values_of(integrator->y));
  double past = fem_signal_past(integrator->time);
  TRY(fem_integrator_restart(integrator, past, u, u + integrator->part.n, 0));
  return choose_stop(integrator);
}

// IDA computes the step's end from its differences. Where that is the state whose forces were evaluated last,
// but for rounding, the values of the evaluation are used, so that nothing is evaluated twice.
static void use_evaluated(FemIntegrator *integrator, double reached) {
  if (integrator->evaluated_time != reached) return;
  N_Vector difference = integrator->interpolated;
  N_VLinearSum(1, integrator->evaluated, -1, integrator->y, difference);
  if (IDAGetErrWeights(integrator->ida, integrator->weights) != IDA_SUCCESS) return;
  N_VProd(difference, integrator->weights, difference);
  if (fem_part_most(N_VMaxNorm(difference)) <= FEM_ROUNDING)
    N_VScale(1, integrator->evaluated, integrator->y);
}

static Status step_ida(FemIntegrator *integrator) {
  double reached;
  TRY(choose_stop(integrator));
  if (fem_integrator_is_at_knot(integrator)) TRY(pass_knot(integrator));
  integrator->failure.retry_message[0] = 0;
  int flag = IDASolve(integrator->ida, integrator->def.end, &reached, integrator->y, integrator->y_dot,
                      IDA_ONE_STEP);
  if (flag < 0) return give_up(integrator, flag);
  use_evaluated(integrator, reached);
  integrator->time = reached;
  integrator->has_steps = true;
  integrator->is_at_knot = integrator->stops_at_knot && reached == integrator->stop;
  return STATUS_OK;
}

Status fem_integrator_step(FemIntegrator *integrator, double *time) {
  *time = integrator->time;
  if (!integrator->is_started || integrator->failure.fatal != STATUS_OK)
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
  IDAGetNumSteps(integrator->ida, &steps);
  IDAGetNumResEvals(integrator->ida, &residuals);
  IDAGetNumLinSolvSetups(integrator->ida, &setups);
  IDAGetNumErrTestFails(integrator->ida, &error_failures);
  IDAGetNumNonlinSolvIters(integrator->ida, &iterations);
  IDAGetNumStepSolveFails(integrator->ida, &failures);
  stats.steps += steps, stats.residuals += residuals, stats.setups += setups;
  stats.error_test_failures += error_failures, stats.newton_iterations += iterations;
  stats.newton_failures += failures;
  if (!integrator->has_steps) return stats;
  IDAGetLastStep(integrator->ida, &stats.last_step);
  IDAGetCurrentStep(integrator->ida, &stats.current_step);
  IDAGetLastOrder(integrator->ida, &stats.last_order);
  return stats;
}

const FemSolverStats *fem_integrator_solver_stats(const FemIntegrator *integrator) {
  return fem_ida_solver_stats(integrator->solver);
}

double fem_integrator_product_s(const FemIntegrator *integrator) {
  return fem_ida_solver_product_s(integrator->solver);
}
