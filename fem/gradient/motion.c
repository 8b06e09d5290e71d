// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/motion.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "fem/statics/equilibrium.h"

enum { MAX_ITERATIONS = 30 };
// A step is balanced once Newton's method does not halve what is left, which is then at most this share of
// the largest force.
static const double LEAST_FALL = 0.5, BALANCE = 1e-9;

Status fem_motion_steps_add(FemMotionSteps *steps, double time) {
  if (!memory_reserve((void **)&steps->times, &steps->capacity, (size_t)steps->count + 1, sizeof time))
    return status_no_memory("the steps of a run");
  steps->times[steps->count++] = time;
  return STATUS_OK;
}

void fem_motion_steps_destroy(FemMotionSteps *steps) {
  memory_free(steps->times);
  *steps = (FemMotionSteps){0};
}

// ẏ_n = c y_n + near y_{n−1} + far y_{n−2}
typedef struct Formula {
  double c, near, far;
} Formula;

typedef struct Replay {
  const FemGradientDef *def;
  const FemMotionSteps *steps;
  FemSystem system;
  FemState state;
  FemEquilibrium equilibrium;
  FemVaried varied;
  int n;
  double *u, *v;                   // of all steps                                     (count, n)
  double *force, *step, *right;    // scratch                                          (n)
  double *beta, *alpha;            // of a step and the two behind it, of each goal    (goal_count, 3, n)
  double *lambda, *slope, *weight; // scratch and ∂g/∂x of each goal  (3 V), (goal_count, 3 V), (3 V)
  double *factors;                 // of the terms of all goals
  double worst;                    // what is left in a step, as a share of scale_of
} Replay;

static void destroy(Replay *replay) {
  fem_varied_destroy(&replay->varied);
  fem_equilibrium_destroy(&replay->equilibrium);
  fem_state_destroy(&replay->state);
  fem_system_destroy(&replay->system);
  double *arrays[] = {replay->u,     replay->v,      replay->force,  replay->step,
                      replay->right, replay->beta,   replay->alpha,  replay->lambda,
                      replay->slope, replay->weight, replay->factors};
  for (int i = 0; i < 11; i++) memory_free(arrays[i]);
}

static Status allocate(Replay *replay) {
  size_t n = (size_t)replay->n, goals = (size_t)replay->def->goal_count, steps = (size_t)replay->steps->count;
  size_t values = 3 * (size_t)replay->system.model->vertex_count, terms = 0;
  for (size_t g = 0; g < goals; g++) terms += (size_t)replay->def->goals[g].term_count;
  const struct {
    double **array;
    size_t count;
  } arrays[] = {{&replay->u, steps * n},
                {&replay->v, steps * n},
                {&replay->force, n},
                {&replay->step, n},
                {&replay->right, n},
                {&replay->beta, 3 * goals * n},
                {&replay->alpha, 3 * goals * n},
                {&replay->lambda, values},
                {&replay->slope, goals * values},
                {&replay->weight, values},
                {&replay->factors, terms}};
  bool fits = true;
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    fits = (*arrays[i].array = memory_zeroed(arrays[i].count, sizeof(double))) && fits;
  return fits ? STATUS_OK : status_no_memory("the replay of a motion");
}

static Status create(Replay *replay, const FemModel *model, const FemGradientDef *def,
                     const FemMotionSteps *steps) {
  *replay = (Replay){.def = def, .steps = steps};
  TRY(fem_system_create(&replay->system, model));
  replay->n = replay->system.numbering.count;
  TRY(allocate(replay));
  TRY(fem_system_create_state(&replay->system, &replay->state));
  TRY(fem_varied_create(&replay->varied, model));
  return fem_equilibrium_create(&replay->equilibrium, &replay->system, &replay->state, &fem_solver_cholmod);
}

// Beyond the steps there is nothing.
static Formula formula_of(const FemMotionSteps *steps, int k) {
  if (k >= steps->count) return (Formula){0, 0, 0};
  const double *t = steps->times + k;
  double h = t[0] - t[-1];
  if (k == 1) return (Formula){1 / h, -1 / h, 0};
  double ratio = h / (t[-1] - t[-2]);
  return (Formula){(1 + 2 * ratio) / (1 + ratio) / h, -(1 + ratio) / h, ratio * ratio / (1 + ratio) / h};
}

static double mass_of(const Replay *replay, int i) {
  return replay->system.model->mass[replay->system.numbering.dof_of_unknown[i] / 3];
}

// ---- Forwards.

// f − M v̇ at u of step k into `force`, where lists follow if the way was long; the largest value.
static Status find_residual(Replay *replay, int k, double *left) {
  Formula formula = formula_of(replay->steps, k);
  size_t n = (size_t)replay->n;
  double time = replay->steps->times[k], *u = replay->u + n * (size_t)k, *v = replay->v + n * (size_t)k;
  Status status = fem_equilibrium_forces(&replay->equilibrium, time, u, replay->force);
  if (status == STATUS_RETRY) {
    TRY(fem_equilibrium_renew(&replay->equilibrium, time, u));
    status = fem_equilibrium_forces(&replay->equilibrium, time, u, replay->force);
  }
  TRY(status);
  for (size_t i = 0; i < n; i++) {
    double far_u = k > 1 ? u[i - 2 * n] : 0, far_v = k > 1 ? v[i - 2 * n] : 0;
    v[i] = formula.c * u[i] + formula.near * u[i - n] + formula.far * far_u;
    replay->force[i] -=
        mass_of(replay, (int)i) * (formula.c * v[i] + formula.near * v[i - n] + formula.far * far_v);
  }
  *left = fem_equilibrium_largest(replay->force, replay->n);
  return STATUS_OK;
}

// What forces and changes of momentum within a step are measured by [N].
static double scale_of(const Replay *replay, int k, double c) {
  const double *v = replay->v + (size_t)replay->n * (size_t)k;
  double scale = fem_equilibrium_largest(replay->system.forces, 3 * replay->system.model->vertex_count);
  for (int i = 0; i < replay->n; i++) scale = fmax(scale, mass_of(replay, i) * c * fabs(v[i]));
  return scale;
}

static Status balance(Replay *replay, int k) {
  Formula formula = formula_of(replay->steps, k);
  size_t n = (size_t)replay->n;
  double time = replay->steps->times[k], *u = replay->u + n * (size_t)k, left;
  TRY(find_residual(replay, k, &left));
  for (int i = 0; i < MAX_ITERATIONS && left > 0; i++) {
    double last = left;
    TRY(fem_equilibrium_factorise(&replay->equilibrium, time, u, formula.c * formula.c));
    TRY(fem_equilibrium_solve(&replay->equilibrium, replay->force, replay->step));
    for (size_t j = 0; j < n; j++) u[j] += replay->step[j];
    TRY(find_residual(replay, k, &left));
    double scale = scale_of(replay, k, formula.c);
    if (!(left <= BALANCE * scale) || left <= LEAST_FALL * last) continue;
    replay->worst = fmax(replay->worst, left / scale);
    return STATUS_OK;
  }
  if (!(left > 0)) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "the replay's step to t = %.9g s cannot be balanced", time);
}

// A failure of a step, with its time; nothing is tried again.
static Status end_step(Status status, double time) {
  if (status != STATUS_RETRY) return status;
  char why[512];
  snprintf(why, sizeof why, "%s", status_message());
  return status_fail(STATUS_SOLVER, "the replay's step to t = %.9g s: %s", time, why);
}

static Status go_forwards(Replay *replay) {
  size_t n = (size_t)replay->n;
  FemSystem *system = &replay->system;
  const double *t = replay->steps->times;
  fem_system_gather(system, &system->accepted, replay->u, replay->v);
  for (int k = 1; k < replay->steps->count; k++) {
    double *u = replay->u + n * (size_t)k, *v = replay->v + n * (size_t)k;
    for (size_t i = 0; i < n; i++) u[i] = u[i - n] + (t[k] - t[k - 1]) * v[i - n];
    TRY(end_step(balance(replay, k), t[k]));
    fem_system_scatter(system, t[k], u, v, &replay->state);
    TRY(fem_system_accept(system, &replay->state, k + 1 < replay->steps->count ? t[k + 1] - t[k] : 0));
  }
  return STATUS_OK;
}

// ---- Backwards.

// The numbers of a step, its places in a ring of three.
static double *of_step(const Replay *replay, double *ring, int g, int k) {
  return ring + (size_t)replay->n * (size_t)(3 * g + k % 3);
}

// s_k, at which two steps and their formulas meet.
static double carried(const Replay *replay, double *ring, int g, int k, int i) {
  double near = formula_of(replay->steps, k + 1).near * of_step(replay, ring, g, k + 1)[i];
  return near + formula_of(replay->steps, k + 2).far * of_step(replay, ring, g, k + 2)[i];
}

static Status solve_step(Replay *replay, int g, int k, const double *slope, double *residual) {
  double c = formula_of(replay->steps, k).c;
  double *beta = of_step(replay, replay->beta, g, k), *alpha = of_step(replay, replay->alpha, g, k);
  for (int i = 0; i < replay->n; i++) {
    double s = mass_of(replay, i) * carried(replay, replay->beta, g, k, i);
    replay->right[i] = -c * s - carried(replay, replay->alpha, g, k, i);
    if (slope) replay->right[i] -= slope[replay->system.numbering.dof_of_unknown[i]];
  }
  TRY(fem_equilibrium_solve(&replay->equilibrium, replay->right, replay->step));
  fem_matrix_multiply(&replay->system.matrix, replay->step, replay->force);
  double whole = 0, left = 0;
  for (int i = 0; i < replay->n; i++) {
    left += (replay->right[i] - replay->force[i]) * (replay->right[i] - replay->force[i]);
    whole += replay->right[i] * replay->right[i];
  }
  if (!isfinite(left) || !isfinite(whole))
    return status_fail(STATUS_SOLVER, "the adjoint of the step to t = %.9g s is not a number",
                       replay->steps->times[k]);
  if (whole > 0) *residual = fmax(*residual, sqrt(left / whole));
  for (int i = 0; i < replay->n; i++) {
    double s = mass_of(replay, i) * carried(replay, replay->beta, g, k, i);
    beta[i] = replay->step[i];
    alpha[i] = c * mass_of(replay, i) * beta[i] + s;
  }
  return STATUS_OK;
}

// −∂M/∂p v̇ of a density: what the body's vertices resist with.
static void resist(Replay *replay, const FemParameter *parameter, int k, double *force) {
  const FemModel *model = replay->system.model;
  if (parameter->kind != FEM_PARAMETER_DENSITY) return;
  const FemModelBody *body = &model->bodies[parameter->body];
  Formula formula = formula_of(replay->steps, k);
  size_t n = (size_t)replay->n;
  const double *v = replay->v + n * (size_t)k;
  for (size_t i = 0; i < n; i++) {
    int dof = replay->system.numbering.dof_of_unknown[i];
    if (dof / 3 < body->vertex_begin || dof / 3 >= body->vertex_end) continue;
    double rate = formula.c * v[i] + formula.near * v[i - n] + (k > 1 ? formula.far * v[i - 2 * n] : 0);
    force[dof] -= mass_of(replay, (int)i) / body->material.density * rate;
  }
}

// Adds what step k gives to the derivatives by one parameter.
static Status add_step(Replay *replay, const FemTangent *tangent, FemChange *change, int p, int k,
                       FemGradient *gradient) {
  const FemGradientDef *def = replay->def;
  size_t values = 3 * (size_t)replay->system.model->vertex_count;
  bool is_last = k == replay->steps->count - 1;
  const double *factors = replay->factors;
  TRY(fem_change_find(change, &replay->varied, tangent, &def->parameters[p], def->follows_choice));
  resist(replay, &def->parameters[p], k, change->force);
  for (int g = 0; g < def->goal_count; g++) {
    const double *beta = of_step(replay, replay->beta, g, k), *slope = replay->slope + values * (size_t)g;
    double sum = 0;
    if (is_last) TRY(fem_goal_change(&def->goals[g], tangent, factors, change, &sum));
    factors += def->goals[g].term_count;
    memset(replay->lambda, 0, values * sizeof(double));
    for (int i = 0; i < replay->n; i++) replay->lambda[replay->system.numbering.dof_of_unknown[i]] = -beta[i];
    fem_tangent_multiply(tangent, replay->lambda, replay->weight);
    for (size_t i = 0; i < values; i++)
      sum += replay->lambda[i] * change->force[i] +
             ((is_last ? slope[i] : 0) - replay->weight[i]) * change->motion[i];
    gradient->derivatives[g * def->parameter_count + p] += sum;
  }
  return STATUS_OK;
}

static Status go_back_by(Replay *replay, const FemTangent *tangent, int k, FemGradient *gradient) {
  FemChange change;
  Status status = fem_change_create(&change, tangent);
  for (int p = 0; p < replay->def->parameter_count && !status; p++)
    status = add_step(replay, tangent, &change, p, k, gradient);
  fem_change_destroy(&change);
  return status;
}

static Status evaluate_goals(Replay *replay, const FemTangent *tangent, FemGradient *gradient) {
  size_t values = 3 * (size_t)replay->system.model->vertex_count;
  double *factors = replay->factors;
  for (int g = 0; g < replay->def->goal_count; g++) {
    TRY(fem_goal_evaluate(&replay->def->goals[g], tangent, &gradient->values[g],
                          replay->slope + values * (size_t)g, factors));
    factors += replay->def->goals[g].term_count;
  }
  return STATUS_OK;
}

static Status go_back_to(Replay *replay, int k, FemGradient *gradient) {
  double c = formula_of(replay->steps, k).c, time = replay->steps->times[k];
  double *u = replay->u + (size_t)replay->n * (size_t)k;
  size_t values = 3 * (size_t)replay->system.model->vertex_count;
  bool is_last = k == replay->steps->count - 1;
  TRY(fem_equilibrium_renew(&replay->equilibrium, time, u));
  TRY(fem_equilibrium_factorise(&replay->equilibrium, time, u, c * c));
  FemTangent tangent;
  Status status = fem_tangent_create(&tangent, &replay->system, &replay->state);
  if (!status && is_last) status = evaluate_goals(replay, &tangent, gradient);
  for (int g = 0; g < replay->def->goal_count && !status; g++)
    status = solve_step(replay, g, k, is_last ? replay->slope + values * (size_t)g : NULL,
                        &gradient->residuals[g]);
  if (!status) status = go_back_by(replay, &tangent, k, gradient);
  fem_tangent_destroy(&tangent);
  return status;
}

// By the velocity that a body starts with: s_0.
static void add_start(Replay *replay, FemGradient *gradient) {
  const FemGradientDef *def = replay->def;
  for (int p = 0; p < def->parameter_count; p++) {
    const FemParameter *parameter = &def->parameters[p];
    if (parameter->kind != FEM_PARAMETER_START) continue;
    const FemModelBody *body = &replay->system.model->bodies[parameter->body];
    for (int g = 0; g < def->goal_count; g++)
      for (int i = 0; i < replay->n; i++) {
        int dof = replay->system.numbering.dof_of_unknown[i];
        if (dof / 3 >= body->vertex_begin && dof / 3 < body->vertex_end && dof % 3 == parameter->component)
          gradient->derivatives[g * def->parameter_count + p] +=
              mass_of(replay, i) * carried(replay, replay->beta, g, 0, i);
      }
  }
}

static Status replay_and_return(Replay *replay, FemGradient *gradient) {
  TRY(go_forwards(replay));
  gradient->unbalanced = replay->worst;
  for (int k = replay->steps->count - 1; k > 0; k--)
    TRY(end_step(go_back_to(replay, k, gradient), replay->steps->times[k]));
  add_start(replay, gradient);
  return STATUS_OK;
}

// ---- What has a derivative.

static Status check_damping(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  for (int b = 0; b < scene->body_count; b++) {
    const FemMaterial *material = &model->bodies[b].material;
    if (model->bodies[b].damping > 0 || material->viscosity > 0 || material->bulk_viscosity > 0)
      return status_fail(STATUS_INPUT,
                         "body '%s' is damped: the matrix lacks what damping changes by positions, so that a "
                         "motion has no exact gradient",
                         model->bodies[b].name);
  }
  if (scene->contact.is_on && scene->contact.viscosity > 0)
    return status_fail(STATUS_INPUT, "contact.viscosity: its matrix is not exact by positions");
  if (scene->contact.is_on && scene->contact.rest_is_on)
    return status_fail(STATUS_INPUT, "contact.rest: bodies that fall asleep have no gradient");
  return STATUS_OK;
}

static Status check_released(const FemModel *model) {
  for (int d = 0; d < model->driver_count; d++)
    if (model->drivers[d].def->release > 0 || model->drivers[d].def->is_external)
      return status_fail(STATUS_INPUT, "what is released or moved from outside has no gradient in a motion");
  return STATUS_OK;
}

Status fem_motion_check(const FemModel *model, const FemGradientDef *def) {
  TRY(check_damping(model));
  TRY(check_released(model));
  for (int p = 0; p < def->parameter_count; p++) {
    const FemParameter *parameter = &def->parameters[p];
    if (parameter->kind == FEM_PARAMETER_PLACE && parameter->obstacle < 0)
      return status_fail(STATUS_INPUT, "the place of a body is a parameter of static scenes alone");
  }
  return STATUS_OK;
}

Status fem_motion_differentiate(FemGradient *gradient, const FemModel *model, const FemGradientDef *def,
                                const FemMotionSteps *steps) {
  TRY(fem_gradient_create(gradient, def));
  TRY(fem_gradient_check(model, def));
  TRY(fem_motion_check(model, def));
  for (int g = 0; g < def->goal_count; g++) gradient->mismatches[g] = NAN;
  if (steps->count < 2) return status_fail(STATUS_INPUT, "the run made no step");
  Replay replay;
  Status status = create(&replay, model, def, steps);
  if (!status) status = replay_and_return(&replay, gradient);
  destroy(&replay);
  return status;
}
