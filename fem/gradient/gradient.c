// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/gradient.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/krylov.h"
#include "fem/sparse/vector.h"
#include "fem/statics/equilibrium.h"

enum { MAX_CORRECTIONS = 8, MAX_REFINEMENTS = 4 };
// Newton's method ends once a step does not halve the force; λ once its residual is this.
static const double LEAST_FALL = 0.5, RESIDUAL = 1e-12;
// What derivatives agree to with differences.
static const double PROMISE = 1e-6;
// How far coordinates move for a difference of forces, as a share of the mean edge.
static const double WAY = 1e-7;

typedef struct Adjoint {
  const FemGradientDef *def; // borrowed
  FemEquilibrium equilibrium;
  FemState state;
  FemTangent tangent;
  FemVaried varied;
  FemChange change;
  FemAnswers answers;                        // of derivatives by weights
  FemKrylov krylov;                          // of overlap models that do not clip
  int count;                                 // n
  double *u, *force, *step, *right, *lambda; // (n)
  double *multipliers; // λ on all vertices, 0 where prescribed    (goal_count, vertex_count, 3)
  double *slopes;      // ∂g/∂x, less K λ                          (goal_count, vertex_count, 3)
  double *factors;     // of the terms of all goals
} Adjoint;

static size_t values_of(const Adjoint *adjoint) {
  return 3 * (size_t)adjoint->equilibrium.system->model->vertex_count;
}

static void destroy(Adjoint *adjoint) {
  fem_answers_destroy(&adjoint->answers);
  fem_krylov_destroy(&adjoint->krylov);
  fem_change_destroy(&adjoint->change);
  fem_varied_destroy(&adjoint->varied);
  fem_tangent_destroy(&adjoint->tangent);
  fem_equilibrium_destroy(&adjoint->equilibrium);
  fem_state_destroy(&adjoint->state);
  double *arrays[] = {adjoint->u,      adjoint->force,       adjoint->step,   adjoint->right,
                      adjoint->lambda, adjoint->multipliers, adjoint->slopes, adjoint->factors};
  for (int i = 0; i < 8; i++) memory_free(arrays[i]);
}

static size_t count_terms(const FemGradientDef *def) {
  size_t count = 0;
  for (int g = 0; g < def->goal_count; g++) count += (size_t)def->goals[g].term_count;
  return count;
}

static Status create(Adjoint *adjoint, FemSystem *system, const FemGradientDef *def) {
  *adjoint = (Adjoint){.def = def, .count = system->numbering.count};
  size_t n = (size_t)adjoint->count, all = 3 * (size_t)system->model->vertex_count * (size_t)def->goal_count;
  double **arrays[] = {&adjoint->u, &adjoint->force, &adjoint->step, &adjoint->right, &adjoint->lambda};
  bool fits = true;
  for (int i = 0; i < 5; i++) fits = (*arrays[i] = memory_zeroed(n, sizeof(double))) && fits;
  fits = (adjoint->multipliers = memory_zeroed(all, sizeof(double))) && fits;
  fits = (adjoint->slopes = memory_zeroed(all, sizeof(double))) && fits;
  fits = (adjoint->factors = memory_zeroed(count_terms(def), sizeof(double))) && fits;
  if (!fits) return status_no_memory("a gradient");
  TRY(fem_system_create_state(system, &adjoint->state));
  TRY(fem_varied_create(&adjoint->varied, system->model));
  return fem_equilibrium_create(&adjoint->equilibrium, system, &adjoint->state, &fem_solver_cholmod);
}

// Newton's method from the accepted state until the force is rounding; the force that is left in `*left`, the
// best positions in u.
static Status settle(Adjoint *adjoint, double time, double *left) {
  FemEquilibrium *equilibrium = &adjoint->equilibrium;
  TRY(fem_equilibrium_forces(equilibrium, time, adjoint->u, adjoint->force));
  *left = fem_equilibrium_largest(adjoint->force, adjoint->count);
  for (int k = 0; k < MAX_CORRECTIONS; k++) {
    if (!(*left > 0)) break;
    TRY(fem_equilibrium_factorise(equilibrium, time, adjoint->u, 0));
    TRY(fem_equilibrium_solve(equilibrium, adjoint->force, adjoint->step));
    for (int i = 0; i < adjoint->count; i++) adjoint->u[i] += adjoint->step[i];
    TRY(fem_equilibrium_forces(equilibrium, time, adjoint->u, adjoint->force));
    double now = fem_equilibrium_largest(adjoint->force, adjoint->count);
    if (!(now <= *left)) // nor if it is no number
      for (int i = 0; i < adjoint->count; i++) adjoint->u[i] -= adjoint->step[i];
    bool has_fallen = now <= LEAST_FALL * *left;
    *left = fmin(*left, now);
    if (!has_fallen) break;
  }
  return STATUS_OK;
}

Status fem_gradient_judge(double residual, double time) {
  if (residual <= PROMISE) return STATUS_OK;
  return status_fail(
      STATUS_SOLVER,
      "the adjoint at t = %.9g s is solved to %.1e only, %.0e is needed: no gradient; take shorter "
      "steps (time.max_step), or in a static scene more frames (output.frames)",
      time, residual, PROMISE);
}

// λ by K's factor, with iterative refinement.
static Status refine(Adjoint *adjoint, double *residual) {
  FemEquilibrium *equilibrium = &adjoint->equilibrium;
  int n = adjoint->count;
  double whole = sqrt(fem_vector_dot(n, adjoint->right, adjoint->right));
  *residual = 0;
  memset(adjoint->lambda, 0, (size_t)n * sizeof(double));
  if (whole == 0) return STATUS_OK;
  memcpy(adjoint->force, adjoint->right, (size_t)n * sizeof(double));
  for (int k = 0; k < MAX_REFINEMENTS; k++) {
    TRY(fem_equilibrium_solve(equilibrium, adjoint->force, adjoint->step));
    for (int i = 0; i < n; i++) adjoint->lambda[i] += adjoint->step[i];
    fem_matrix_multiply(&equilibrium->system->matrix, adjoint->lambda, adjoint->force);
    for (int i = 0; i < n; i++) adjoint->force[i] = adjoint->right[i] - adjoint->force[i];
    *residual = sqrt(fem_vector_dot(n, adjoint->force, adjoint->force)) / whole;
    if (*residual <= RESIDUAL) break;
  }
  return STATUS_OK;
}

// y = Jᵀ x over the unknowns.
static Status multiply(void *self, const double *x, double *y) {
  Adjoint *adjoint = self;
  const int *dofs = adjoint->equilibrium.system->numbering.dof_of_unknown;
  double *from = adjoint->change.product, *to = adjoint->change.contact;
  memset(from, 0, values_of(adjoint) * sizeof *from);
  for (int i = 0; i < adjoint->count; i++) from[dofs[i]] = x[i];
  TRY(fem_tangent_pull(&adjoint->tangent, from, to));
  for (int i = 0; i < adjoint->count; i++) y[i] = to[dofs[i]];
  return STATUS_OK;
}

static Status precondition(void *self, const double *x, double *y) {
  return fem_equilibrium_solve(&((Adjoint *)self)->equilibrium, x, y);
}

static Status create_krylov(Adjoint *adjoint) {
  if (!fem_remainder_is_there(adjoint->equilibrium.system->model)) return STATUS_OK;
  adjoint->krylov = (FemKrylov){.self = adjoint, .multiply = multiply, .precondition = precondition};
  return fem_krylov_create(&adjoint->krylov, adjoint->count);
}

static Status solve(Adjoint *adjoint, double *residual) {
  if (adjoint->krylov.self)
    TRY(fem_krylov_solve(&adjoint->krylov, adjoint->right, RESIDUAL, adjoint->lambda, residual));
  else
    TRY(refine(adjoint, residual));
  return fem_gradient_judge(*residual, adjoint->state.time);
}

// J λ into `step`.
static void push(Adjoint *adjoint) {
  const FemSystem *system = adjoint->equilibrium.system;
  const int *dofs = system->numbering.dof_of_unknown;
  double *from = adjoint->change.product, *to = adjoint->change.contact;
  fem_matrix_multiply(&system->matrix, adjoint->lambda, adjoint->step);
  memset(from, 0, values_of(adjoint) * sizeof *from);
  memset(to, 0, values_of(adjoint) * sizeof *to);
  for (int i = 0; i < adjoint->count; i++) from[dofs[i]] = adjoint->lambda[i];
  fem_tangent_add_remainder(&adjoint->tangent, from, to);
  for (int i = 0; i < adjoint->count; i++) adjoint->step[i] += to[dofs[i]];
}

// How far J λ is from the difference of forces along λ.
static Status compare(Adjoint *adjoint, double *mismatch) {
  FemSystem *system = adjoint->equilibrium.system;
  int n = adjoint->count;
  double largest = fem_equilibrium_largest(adjoint->lambda, n), sum = 0, whole = 0;
  *mismatch = 0;
  if (!(largest > 0)) return STATUS_OK;
  double share = WAY * system->model->edge / largest, time = adjoint->state.time;
  double *ahead = adjoint->right, *behind = adjoint->force;
  for (int side = 1; side >= -1; side -= 2) {
    for (int i = 0; i < n; i++) adjoint->step[i] = adjoint->u[i] + side * share * adjoint->lambda[i];
    TRY(fem_equilibrium_forces(&adjoint->equilibrium, time, adjoint->step, side > 0 ? ahead : behind));
  }
  for (int i = 0; i < n; i++) ahead[i] = (ahead[i] - behind[i]) / (2 * share);
  push(adjoint);
  for (int i = 0; i < n; i++) {
    sum += (adjoint->step[i] + ahead[i]) * (adjoint->step[i] + ahead[i]);
    whole += adjoint->step[i] * adjoint->step[i];
  }
  *mismatch = sqrt(sum / whole);
  return fem_equilibrium_forces(&adjoint->equilibrium, time, adjoint->u, adjoint->force);
}

// NaN is the worst.
static double worse(double a, double b) {
  return isnan(b) || b > a ? b : a;
}

// g, λ, and what is left of ∂g/∂x on the prescribed coordinates.
static Status solve_goal(Adjoint *adjoint, int g, double *factors, FemGradient *gradient) {
  const FemNumbering *numbering = &adjoint->equilibrium.system->numbering;
  size_t values = values_of(adjoint);
  double *slope = adjoint->slopes + values * (size_t)g, *all = adjoint->multipliers + values * (size_t)g;
  double residual, mismatch;
  if (gradient->weights) TRY(fem_tangent_begin_answers(&adjoint->tangent, &adjoint->answers));
  adjoint->tangent.answers = gradient->weights ? &adjoint->answers : NULL;
  TRY(fem_goal_evaluate(&adjoint->def->goals[g], &adjoint->tangent, &gradient->values[g], slope, factors));
  for (int i = 0; i < adjoint->count; i++) adjoint->right[i] = slope[numbering->dof_of_unknown[i]];
  TRY(solve(adjoint, &residual));
  for (int i = 0; i < adjoint->count; i++) all[numbering->dof_of_unknown[i]] = adjoint->lambda[i];
  TRY(compare(adjoint, &mismatch));
  gradient->residuals[g] = worse(gradient->residuals[g], residual);
  gradient->mismatches[g] = worse(gradient->mismatches[g], mismatch);
  TRY(fem_tangent_pull(&adjoint->tangent, all, adjoint->change.product));
  for (size_t i = 0; i < values; i++) slope[i] -= adjoint->change.product[i];
  if (!gradient->weights) return STATUS_OK;
  TRY(fem_tangent_pull_contact(&adjoint->tangent, CONTACT_ALL_INTERFACES, all, 1));
  return fem_tangent_train(&adjoint->tangent, gradient->weights + gradient->weight_count * (size_t)g);
}

static bool is_due(const Adjoint *adjoint, int g) {
  return fem_goal_is_due(&adjoint->def->goals[g], adjoint->equilibrium.system->model, adjoint->state.time);
}

static Status solve_goals(Adjoint *adjoint, FemGradient *gradient) {
  double *factors = adjoint->factors;
  for (int g = 0; g < adjoint->def->goal_count; g++) {
    if (is_due(adjoint, g)) TRY(solve_goal(adjoint, g, factors, gradient));
    factors += adjoint->def->goals[g].term_count;
  }
  return STATUS_OK;
}

// All goals by one parameter.
static Status differentiate(Adjoint *adjoint, int p, FemGradient *gradient) {
  const FemGradientDef *def = adjoint->def;
  FemChange *change = &adjoint->change;
  const double *factors = adjoint->factors;
  size_t values = values_of(adjoint);
  TRY(fem_gradient_pass(gradient, def, p,
                        fem_change_find(change, &adjoint->varied, &adjoint->tangent, &def->parameters[p],
                                        def->follows_choice)));
  if (gradient->kinks[p]) return STATUS_OK;
  for (int g = 0; g < def->goal_count; g++) {
    const double *lambda = adjoint->multipliers + values * (size_t)g;
    const double *slope = adjoint->slopes + values * (size_t)g;
    double sum;
    TRY(fem_goal_change(&def->goals[g], &adjoint->tangent, factors, change, &sum));
    for (size_t i = 0; i < values; i++) sum += lambda[i] * change->force[i] + slope[i] * change->motion[i];
    gradient->derivatives[g * def->parameter_count + p] += sum;
    factors += def->goals[g].term_count;
  }
  return STATUS_OK;
}

static Status find(FemGradient *gradient, Adjoint *adjoint) {
  FemEquilibrium *equilibrium = &adjoint->equilibrium;
  FemSystem *system = equilibrium->system;
  double time = system->accepted.time, left;
  fem_system_gather(system, &system->accepted, adjoint->u, adjoint->step);
  TRY(settle(adjoint, time, &left));
  TRY(fem_equilibrium_forces(equilibrium, time, adjoint->u, adjoint->force));
  double largest = fem_equilibrium_largest(system->forces, 3 * system->model->vertex_count);
  gradient->unbalanced = worse(gradient->unbalanced, largest > 0 ? left / largest : 0);
  TRY(fem_equilibrium_factorise(equilibrium, time, adjoint->u, 0));
  TRY(fem_tangent_create(&adjoint->tangent, system));
  TRY(fem_tangent_find(&adjoint->tangent, &adjoint->state));
  TRY(fem_change_create(&adjoint->change, &adjoint->tangent));
  TRY(create_krylov(adjoint));
  TRY(solve_goals(adjoint, gradient));
  for (int p = 0; p < adjoint->def->parameter_count; p++)
    if (!gradient->kinks[p]) TRY(differentiate(adjoint, p, gradient));
  return STATUS_OK;
}

bool fem_gradient_has_friction(const FemModel *model) {
  return model->scene->contact.is_on && fem_scene_most_friction(&model->scene->contact) > 0;
}

bool fem_gradient_has_following(const FemModel *model) {
  for (int l = 0; l < model->load_count; l++)
    if (model->loads[l].triangle_count + model->loads[l].face_count > 0) return true;
  return false;
}

bool fem_gradient_yields(const FemModel *model) {
  return fem_effect_plasticity.is_wanted(model->scene);
}

bool fem_gradient_is_path(const FemModel *model) {
  return !model->scene->is_static || fem_gradient_has_friction(model) || fem_gradient_yields(model) ||
         fem_gradient_has_following(model);
}

static Status check_contact(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  if (!contact->is_on) return STATUS_OK;
  if (contact->potential != CONTACT_POTENTIAL_FIELD)
    return status_fail(STATUS_INPUT, "contact.potential: gradients need field");
  return fem_remainder_check(model);
}

static Status check_body(const FemBodyDef *body) {
  for (int i = 0; i < body->load_count; i++)
    if (body->loads[i].kind == FEM_LOAD_TORQUE)
      return status_fail(
          STATUS_INPUT,
          "body '%s', loads[%d] is a torque, whose derivative by positions is not in the matrix", body->name,
          i);
  return STATUS_OK;
}

static Status check_scene(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (model->free_count == 0) return status_fail(STATUS_INPUT, "nothing moves freely in the scene");
  if (model->share) return status_fail(STATUS_INPUT, "gradients are found by one process: run tetlap alone");
  TRY(check_contact(model));
  for (int b = 0; b < scene->body_count; b++) TRY(check_body(&scene->bodies[b]));
  return STATUS_OK;
}

static bool has_pressure(const FemGradientDef *def) {
  for (int g = 0; g < def->goal_count; g++)
    for (int t = 0; t < def->goals[g].term_count; t++)
      if (def->goals[g].terms[t].quantity.kind == FEM_QUANTITY_PRESSURE) return true;
  return false;
}

// Of parameters that change a body's shape.
static Status check_shapes(const FemModel *model, const FemGradientDef *def) {
  const FemSceneDef *scene = model->scene;
  bool is_asked = false, meets_itself = false;
  for (int p = 0; p < def->parameter_count; p++)
    is_asked = is_asked || fem_parameter_is_of_shape(&def->parameters[p]);
  for (int b = 0; b < scene->body_count; b++) meets_itself = meets_itself || scene->bodies[b].self_contact;
  if (!is_asked) return STATUS_OK;
  if (fem_gradient_yields(model))
    return status_fail(STATUS_INPUT, "with plasticity there is no derivative by a body's shape");
  if (meets_itself || model->start)
    return status_fail(STATUS_INPUT, "by a body's shape there is no derivative %s",
                       meets_itself ? "with self_contact" : "of a run that goes on from another");
  if (has_pressure(def))
    return status_fail(STATUS_INPUT,
                       "pressures have no derivative by a body's shape: take the force patch:PROBE:AXIS");
  return STATUS_OK;
}

Status fem_gradient_check(const FemModel *model, const FemGradientDef *def) {
  TRY(check_scene(model));
  for (int g = 0; g < def->goal_count; g++)
    for (int t = 0; t < def->goals[g].term_count; t++)
      TRY(fem_quantity_check(model, &def->goals[g].terms[t].quantity));
  for (int p = 0; p < def->parameter_count; p++) TRY(fem_parameter_check(model, &def->parameters[p]));
  TRY(check_shapes(model, def));
  size_t count;
  return def->by_weights ? fem_answers_count_weights(model, &count) : STATUS_OK;
}

Status fem_gradient_make_weights(FemGradient *gradient, const FemModel *model, const FemGradientDef *def) {
  if (!def->by_weights || gradient->weights) return STATUS_OK;
  TRY(fem_answers_count_weights(model, &gradient->weight_count));
  gradient->weights = memory_zeroed((size_t)def->goal_count * gradient->weight_count, sizeof(double));
  return gradient->weights ? STATUS_OK : status_no_memory("derivatives by weights");
}

Status fem_gradient_create(FemGradient *gradient, const FemGradientDef *def) {
  size_t goals = (size_t)def->goal_count;
  *gradient =
      (FemGradient){.parameter_count = def->parameter_count,
                    .values = memory_zeroed(goals, sizeof(double)),
                    .residuals = memory_zeroed(goals, sizeof(double)),
                    .mismatches = memory_zeroed(goals, sizeof(double)),
                    .derivatives = memory_zeroed(goals * (size_t)def->parameter_count, sizeof(double)),
                    .kinks = memory_zeroed((size_t)def->parameter_count, sizeof(char *))};
  bool fits = gradient->values && gradient->residuals && gradient->mismatches && gradient->derivatives &&
              gradient->kinks;
  return fits ? STATUS_OK : status_no_memory("a gradient");
}

Status fem_gradient_pass(FemGradient *gradient, const FemGradientDef *def, int p, Status status) {
  if (status != STATUS_INPUT || !fem_parameter_is_of_shape(&def->parameters[p])) return status;
  const char *why = status_message();
  gradient->kink_count++;
  if (gradient->kink_count == def->parameter_count && !def->by_weights) return status;
  gradient->kinks[p] = memory_copy(why, strlen(why) + 1, 1);
  for (int g = 0; g < def->goal_count; g++) gradient->derivatives[g * def->parameter_count + p] = NAN;
  return gradient->kinks[p] ? STATUS_OK : status_no_memory("a gradient");
}

Status fem_gradient_find(FemGradient *gradient, FemSystem *system, const FemGradientDef *def) {
  if (!gradient->values) TRY(fem_gradient_create(gradient, def));
  TRY(fem_gradient_check(system->model, def));
  TRY(fem_gradient_make_weights(gradient, system->model, def));
  if (!system->model->scene->is_static)
    return status_fail(STATUS_INPUT, "the scene moves: it ends in no equilibrium");
  if (fem_gradient_has_friction(system->model))
    return status_fail(STATUS_INPUT,
                       "friction remembers what has been: an equilibrium alone has no gradient");
  if (fem_gradient_yields(system->model))
    return status_fail(STATUS_INPUT,
                       "plasticity remembers what has been: an equilibrium alone has no gradient");
  if (fem_gradient_has_following(system->model))
    return status_fail(STATUS_INPUT, "a pressure that follows its surface: the matrix is not symmetric");
  Adjoint adjoint;
  Status status = create(&adjoint, system, def);
  if (!status) status = find(gradient, &adjoint);
  gradient->time = system->accepted.time;
  destroy(&adjoint);
  if (status != STATUS_RETRY) return status;
  char why[512];
  snprintf(why, sizeof why, "%s", status_message());
  return status_fail(STATUS_SOLVER, "no gradient at t = %.9g: the equilibrium is not a stable one: %s",
                     system->accepted.time, why);
}

void fem_gradient_destroy(FemGradient *gradient) {
  for (int k = 0; gradient->kinks && k < gradient->parameter_count; k++) memory_free(gradient->kinks[k]);
  memory_free(gradient->kinks);
  memory_free(gradient->values);
  memory_free(gradient->residuals);
  memory_free(gradient->mismatches);
  memory_free(gradient->derivatives);
  memory_free(gradient->weights);
  *gradient = (FemGradient){0};
}
