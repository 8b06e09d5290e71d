// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/gradient.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "fem/statics/equilibrium.h"

enum { MAX_CORRECTIONS = 8, MAX_REFINEMENTS = 4 };
// Newton's method ends once a step does not halve the force; λ once its residual is this.
static const double LEAST_FALL = 0.5, RESIDUAL = 1e-12;

typedef struct Adjoint {
  FemEquilibrium equilibrium;
  FemState state;
  int count;                                 // n
  double *u, *force, *step, *right, *lambda; // (n)
  double *along;                             // ∂f/∂p on all vertices      (vertex_count, 3)
} Adjoint;

static void destroy(Adjoint *adjoint) {
  fem_equilibrium_destroy(&adjoint->equilibrium);
  fem_state_destroy(&adjoint->state);
  double *arrays[] = {adjoint->u,     adjoint->force,  adjoint->step,
                      adjoint->right, adjoint->lambda, adjoint->along};
  for (int i = 0; i < 6; i++) memory_free(arrays[i]);
}

static Status create(Adjoint *adjoint, FemSystem *system) {
  *adjoint = (Adjoint){.count = system->numbering.count};
  size_t n = (size_t)adjoint->count, values = 3 * (size_t)system->model->vertex_count;
  adjoint->u = memory_zeroed(n, sizeof(double));
  adjoint->force = memory_zeroed(n, sizeof(double));
  adjoint->step = memory_zeroed(n, sizeof(double));
  adjoint->right = memory_zeroed(n, sizeof(double));
  adjoint->lambda = memory_zeroed(n, sizeof(double));
  adjoint->along = memory_zeroed(values, sizeof(double));
  if (!adjoint->u || !adjoint->force || !adjoint->step || !adjoint->right || !adjoint->lambda ||
      !adjoint->along)
    return status_no_memory("a gradient");
  TRY(fem_system_create_state(system, &adjoint->state));
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

// g and ∂g/∂x on the unknowns.
static double evaluate(const FemSystem *system, const FemState *state, const FemQuantity *quantity,
                       double *right) {
  const FemModel *model = system->model;
  const FemModelBody *body = &model->bodies[quantity->body];
  double share = 1.0 / (body->vertex_end - body->vertex_begin), sum = 0;
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    size_t dof = 3 * (size_t)a + (size_t)quantity->component;
    sum += share * (state->positions[dof] - model->rest[dof]);
    int unknown = system->numbering.unknown_of_dof[dof];
    if (unknown >= 0) right[unknown] = share;
  }
  return sum;
}

// K λ = ∂g/∂x by K's factor, with iterative refinement.
static Status solve(Adjoint *adjoint, double time, double *residual) {
  FemEquilibrium *equilibrium = &adjoint->equilibrium;
  int n = adjoint->count;
  double whole = sqrt(fem_solver_dot(adjoint->right, adjoint->right, n));
  *residual = 0;
  if (!(whole > 0)) return STATUS_OK;
  TRY(fem_equilibrium_factorise(equilibrium, time, adjoint->u, 0));
  memcpy(adjoint->force, adjoint->right, (size_t)n * sizeof(double));
  for (int k = 0; k < MAX_REFINEMENTS; k++) {
    TRY(fem_equilibrium_solve(equilibrium, adjoint->force, adjoint->step));
    for (int i = 0; i < n; i++) adjoint->lambda[i] += adjoint->step[i];
    fem_matrix_multiply(&equilibrium->system->matrix, adjoint->lambda, adjoint->force);
    for (int i = 0; i < n; i++) adjoint->force[i] = adjoint->right[i] - adjoint->force[i];
    *residual = sqrt(fem_solver_dot(adjoint->force, adjoint->force, n)) / whole;
    if (*residual <= RESIDUAL) break;
  }
  return STATUS_OK;
}

// λ · ∂f/∂p; no parameter acts on a displacement at fixed positions.
static Status differentiate(Adjoint *adjoint, const FemParameter *parameter, double *derivative) {
  FemSystem *system = adjoint->equilibrium.system;
  memset(adjoint->along, 0, 3 * (size_t)system->model->vertex_count * sizeof(double));
  TRY(fem_parameter_add_force(parameter, system, &adjoint->state, adjoint->along));
  *derivative = 0;
  for (int i = 0; i < adjoint->count; i++)
    *derivative += adjoint->lambda[i] * adjoint->along[system->numbering.dof_of_unknown[i]];
  return STATUS_OK;
}

static Status find(FemGradient *gradient, Adjoint *adjoint, const FemQuantity *quantity,
                   const FemParameter *parameters, int parameter_count) {
  FemSystem *system = adjoint->equilibrium.system;
  double time = system->accepted.time, left;
  fem_system_gather(system, &system->accepted, adjoint->u, adjoint->step);
  TRY(settle(adjoint, time, &left));
  TRY(fem_equilibrium_forces(&adjoint->equilibrium, time, adjoint->u, adjoint->force));
  double largest = fem_equilibrium_largest(system->forces, 3 * system->model->vertex_count);
  gradient->unbalanced = largest > 0 ? left / largest : 0;
  gradient->value = evaluate(system, &adjoint->state, quantity, adjoint->right);
  TRY(solve(adjoint, time, &gradient->residual));
  for (int p = 0; p < parameter_count; p++)
    TRY(differentiate(adjoint, &parameters[p], &gradient->derivatives[p]));
  return STATUS_OK;
}

static Status check_contact(const FemSceneDef *scene) {
  const FemContactDef *contact = &scene->contact;
  if (!contact->is_on) return STATUS_OK;
  if (fem_scene_most_friction(contact) > 0)
    return status_fail(STATUS_INPUT,
                       "friction remembers its history, which gradients do not go back through");
  if (strcmp(contact->overlap, "clip") != 0)
    return status_fail(STATUS_INPUT,
                       "contact.overlap: '%s' has no exact second derivatives in the matrix; gradients need "
                       "clip",
                       contact->overlap);
  if (contact->potential != CONTACT_POTENTIAL_FIELD)
    return status_fail(STATUS_INPUT, "contact.potential: gradients need field");
  if (!contact->use_full_hessian)
    return status_fail(STATUS_INPUT, "contact.hessian: gradients need the full one");
  return STATUS_OK;
}

static Status check_body(const FemBodyDef *body) {
  if (body->material.yield_stress > 0)
    return status_fail(STATUS_INPUT,
                       "body '%s' yields: plasticity remembers its history, which gradients do not go back "
                       "through",
                       body->name);
  for (int i = 0; i < body->load_count; i++)
    if (body->loads[i].kind == FEM_LOAD_TORQUE ||
        (body->loads[i].kind == FEM_LOAD_PRESSURE && !body->loads[i].is_dead))
      return status_fail(STATUS_INPUT,
                         "body '%s', loads[%d] turns with the body: its matrix need not be symmetric",
                         body->name, i);
  return STATUS_OK;
}

Status fem_gradient_check(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (!scene->is_static)
    return status_fail(STATUS_INPUT, "the scene moves; gradients are of static scenes: time: {static: true}");
  if (model->free_count == 0) return status_fail(STATUS_INPUT, "nothing moves freely in the scene");
  TRY(check_contact(scene));
  for (int b = 0; b < scene->body_count; b++) TRY(check_body(&scene->bodies[b]));
  return STATUS_OK;
}

Status fem_gradient_find(FemGradient *gradient, FemSystem *system, const FemQuantity *quantity,
                         const FemParameter *parameters, int parameter_count) {
  *gradient = (FemGradient){.derivatives = memory_zeroed((size_t)parameter_count, sizeof(double))};
  if (!gradient->derivatives) return status_no_memory("a gradient");
  TRY(fem_gradient_check(system->model));
  for (int p = 0; p < parameter_count; p++) TRY(fem_parameter_check(system->model, &parameters[p]));
  Adjoint adjoint;
  Status status = create(&adjoint, system);
  if (!status) status = find(gradient, &adjoint, quantity, parameters, parameter_count);
  destroy(&adjoint);
  if (status != STATUS_RETRY) return status;
  char why[512];
  snprintf(why, sizeof why, "%s", status_message());
  return status_fail(STATUS_SOLVER, "no gradient at t = %.9g: the equilibrium is not a stable one: %s",
                     system->accepted.time, why);
}

void fem_gradient_destroy(FemGradient *gradient) {
  memory_free(gradient->derivatives);
  *gradient = (FemGradient){0};
}
