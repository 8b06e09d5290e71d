// SPDX-License-Identifier: GPL-3.0-or-later
// Systems small enough to have closed forms, for tests of fem/time/integrator.h: chains of masses under an
// effect of the tests' own, whose law is a function.
#ifndef TETLAP_TESTS_TOY_H
#define TETLAP_TESTS_TOY_H

#include "suite.h"

#include <string.h>

#include "base/memory.h"
#include "fem/model/build.h"
#include "fem/time/integrator.h"

static const FemSolverKind KINDS[] = {FEM_SOLVER_CHOLMOD, FEM_SOLVER_KLU, FEM_SOLVER_PCG};
enum { KIND_COUNT = 3, MOST = 3 };

// Masses at vertices that move along x; x = displacement.
typedef struct Toy {
  int count;
  double mass;
  double wall_stiffness;  // of a spring to the rest position of each mass [N/m]
  double link_stiffness;  // of springs between neighbours and from the ends to fixed points [N/m]
  double gravity;         // along x [m/s²]
  double damper;          // [N s/m], the effect `damping`
  double floor_stiffness; // one-sided spring at x < 0 [N/m]
  double friction;        // force against the sign of x: a jump [N]
  double margin;          // positions further than this from `accepted` are a RETRY; 0: none [m]
  double accepted;        // position of the first mass at the last renewal of lists [m]
  double broken_after;    // forces fail from this time on with `failure`; 0: never [s]
  Status failure;
  int evaluations, retries;
  // The system around it.
  FemSceneDef scene;
  FemBodyDef body_def;
  FemModelBody body;
  FemModel model;
  FemSystem system;
  FemState state; // under trial
  double rest[3 * MOST], masses[MOST];
  FemConstraintDef constraint;
  FemModelDriver driver; // y and z are held
  int dofs[2 * MOST];
} Toy;

static inline Status add_force(void *self, const FemState *state, double *force) {
  Toy *toy = *(Toy **)self;
  toy->evaluations++;
  if (toy->broken_after > 0 && state->time > toy->broken_after)
    return status_fail(toy->failure, "the force broke");
  double x[MOST + 2] = {0};
  for (int i = 0; i < toy->count; i++) x[i + 1] = state->positions[3 * i] - toy->rest[3 * i];
  for (int i = 0; i < toy->count; i++) {
    double here = x[i + 1];
    if (toy->margin > 0 && fabs(here - toy->accepted) > toy->margin) {
      toy->retries++;
      return status_fail(STATUS_RETRY, "beyond the margin");
    }
    force[3 * i] += toy->mass * toy->gravity - toy->wall_stiffness * here -
                    toy->link_stiffness * (2 * here - x[i] - x[i + 2]) - toy->floor_stiffness * fmin(here, 0);
    if (here != 0) force[3 * i] -= copysign(toy->friction, here);
  }
  return STATUS_OK;
}

static inline Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  Toy *toy = *(Toy **)self;
  (void)state;
  int vertices[MOST] = {0, 1, 2};
  return fem_pattern_add_clique(pattern, toy->count, vertices, has_grown);
}

static inline Status add_jacobian(void *self, const FemState *state, double stiffness_scale,
                                  double damping_scale, FemMatrix *matrix) {
  (void)damping_scale;
  const Toy *toy = *(Toy **)self;
  double dense[9 * MOST * MOST] = {0};
  int vertices[MOST] = {0, 1, 2}, size = 3 * toy->count;
  for (int i = 0; i < toy->count; i++) {
    double here = state->positions[3 * i] - toy->rest[3 * i];
    double stiffness = toy->wall_stiffness + 2 * toy->link_stiffness + (here < 0 ? toy->floor_stiffness : 0);
    dense[3 * i * size + 3 * i] = stiffness;
    if (i > 0) dense[3 * i * size + 3 * (i - 1)] = dense[3 * (i - 1) * size + 3 * i] = -toy->link_stiffness;
  }
  fem_matrix_add(matrix, toy->count, vertices, dense, stiffness_scale);
  return STATUS_OK;
}

static inline Status renew(void *self, const FemState *state, double step) {
  Toy *toy = *(Toy **)self;
  (void)step;
  toy->accepted = state->positions[0];
  return STATUS_OK;
}

static inline Status add_damper_force(void *self, const FemState *state, double *force) {
  const Toy *toy = *(Toy **)self;
  for (int i = 0; i < toy->count; i++) force[3 * i] -= toy->damper * state->velocities[3 * i];
  return STATUS_OK;
}

static inline Status add_damper_jacobian(void *self, const FemState *state, double stiffness_scale,
                                         double damping_scale, FemMatrix *matrix) {
  (void)state, (void)stiffness_scale;
  const Toy *toy = *(Toy **)self;
  double one[MOST] = {1, 1, 1};
  fem_matrix_add_mass(matrix, one, damping_scale * toy->damper);
  return STATUS_OK;
}

static inline void forget(void *self) {
  memory_free(self);
}

static const FemEffectOps law = {
    .name = "law", .couple = couple, .add_force = add_force, .add_jacobian = add_jacobian, .destroy = forget};
static const FemEffectOps law_with_lists = {.name = "law",
                                            .couple = couple,
                                            .renew = renew,
                                            .add_force = add_force,
                                            .add_jacobian = add_jacobian,
                                            .destroy = forget};
static const FemEffectOps damper = {
    .name = "damping", .add_force = add_damper_force, .add_jacobian = add_damper_jacobian, .destroy = forget};

// What effects keep is memory of their own, which is weighed: a pointer to the toy.
static inline void add_effect(Toy *toy, const FemEffectOps *ops) {
  toy->system.effects[toy->system.effect_count++] =
      (FemEffect){.ops = ops, .self = memory_copy(&toy, 1, sizeof toy)};
}

// The model and system around a toy whose law is filled in; y and z are prescribed.
static inline void toy_open(Toy *toy) {
  static const char name[] = "chain";
  toy->body = (FemModelBody){.name = name, .vertex_end = toy->count};
  toy->scene =
      (FemSceneDef){.solver_tolerance = 1e-12, .threads = 1, .bodies = &toy->body_def, .body_count = 1};
  for (int i = 0; i < toy->count; i++) {
    toy->rest[3 * i] = toy->count > 1 ? i : 0;
    toy->masses[i] = toy->mass;
    toy->dofs[2 * i] = 3 * i + 1, toy->dofs[2 * i + 1] = 3 * i + 2;
  }
  toy->driver = (FemModelDriver){
      .def = &toy->constraint, .is_fixed = true, .dofs = toy->dofs, .dof_count = 2 * toy->count};
  toy->model = (FemModel){.scene = &toy->scene,
                          .vertex_count = toy->count,
                          .body_count = 1,
                          .rest = toy->rest,
                          .bodies = &toy->body,
                          .mass = toy->masses,
                          .drivers = &toy->driver,
                          .driver_count = 1};
  FemSystem *system = &toy->system;
  size_t dofs = 3 * (size_t)toy->count;
  const double still[3 * MOST] = {0};
  *system = (FemSystem){.model = &toy->model, .forces = memory_zeroed(dofs, sizeof(double))};
  ck_assert_ok(fem_numbering_create(&system->numbering, &toy->model));
  ck_assert_ok(fem_state_create(&system->accepted, toy->count, toy->rest, still));
  ck_assert_ok(fem_system_create_state(system, &toy->state));
  add_effect(toy, toy->margin > 0 ? &law_with_lists : &law);
  if (toy->damper > 0) add_effect(toy, &damper);
  ck_assert_ok(fem_pattern_create(&system->pattern, toy->count));
  ck_assert_ok(couple(&toy, NULL, system->pattern, NULL));
  ck_assert_ok(fem_matrix_create(&system->matrix, system->pattern, system->numbering.unknown_of_dof));
}

static inline void toy_close(Toy *toy) {
  fem_state_destroy(&toy->state);
  fem_system_destroy(&toy->system);
}

static inline void toy_accept(Toy *toy, double time, const double *u, const double *v) {
  fem_system_scatter(&toy->system, time, u, v, &toy->state);
  ck_assert_ok(fem_system_accept(&toy->system, &toy->state, 0));
}

static inline FemIntegratorDef def_of(double tolerance, double end) {
  return (FemIntegratorDef){
      .displacement_tolerance = tolerance, .velocity_tolerance = tolerance, .max_order = 2, .end = end};
}

static inline FemIntegrator *start(Toy *toy, FemSolverKind kind, FemIntegratorDef def, const double *u,
                                   const double *v) {
  FemIntegrator *integrator;
  ck_assert_ok(fem_integrator_create(&integrator, &toy->system, &toy->state, fem_solver_ops(kind), &def));
  ck_assert_ok(fem_integrator_restart(integrator, 0, u, v, 0));
  return integrator;
}

// Steps to the end; u, v (count) there.
static inline void finish(FemIntegrator *integrator, double end, int count, double *u, double *v) {
  double time = 0;
  while (time < end) ck_assert_ok(fem_integrator_step(integrator, &time));
  const double *u_end, *v_end;
  ck_assert(time == end);
  ck_assert_ok(fem_integrator_at(integrator, end, &u_end, &v_end));
  memcpy(u, u_end, (size_t)count * sizeof *u);
  memcpy(v, v_end, (size_t)count * sizeof *v);
}

#endif
