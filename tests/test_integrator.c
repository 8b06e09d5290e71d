// SPDX-License-Identifier: GPL-3.0-or-later
// fem/integrator on systems small enough to have closed forms: chains of masses under an effect of the test's
// own, whose law is a function; then a beam of tetrahedra with every solver.
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
  double accepted;        // position of the first mass at the last prepare [m]
  double broken_after;    // forces fail from this time on with `failure`; 0: never [s]
  Status failure;
  bool is_watching; // the mass was above the floor at the last prepare
  int evaluations, retries;
  // The system around it.
  FemSceneDef scene;
  FemModelBody body;
  FemModel model;
  FemSystem system;
  double rest[3 * MOST], masses[MOST];
  int unknown_of_dof[3 * MOST], dof_of_unknown[MOST];
} Toy;

static Status add_force(void *self, const FemState *state, double *force) {
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

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  Toy *toy = *(Toy **)self;
  (void)state;
  int vertices[MOST] = {0, 1, 2};
  return fem_pattern_add_clique(pattern, toy->count, vertices, has_grown);
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
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

static Status prepare(void *self, const FemState *state, double step) {
  Toy *toy = *(Toy **)self;
  (void)step;
  toy->accepted = state->positions[0];
  toy->is_watching = toy->floor_stiffness > 0 && toy->accepted > 1e-9;
  return STATUS_OK;
}

static Status gap(void *self, const FemState *state, double *gap) {
  *gap = (*(Toy **)self)->is_watching ? state->positions[0] : 1;
  return STATUS_OK;
}

static Status add_damper_force(void *self, const FemState *state, double *force) {
  const Toy *toy = *(Toy **)self;
  for (int i = 0; i < toy->count; i++) force[3 * i] -= toy->damper * state->velocities[3 * i];
  return STATUS_OK;
}

static Status add_damper_jacobian(void *self, const FemState *state, double stiffness_scale,
                                  double damping_scale, FemMatrix *matrix) {
  (void)state, (void)stiffness_scale;
  const Toy *toy = *(Toy **)self;
  double one[MOST] = {1, 1, 1};
  fem_matrix_add_mass(matrix, one, damping_scale * toy->damper);
  return STATUS_OK;
}

static void forget(void *self) {
  memory_free(self);
}

static const FemEffectOps law = {
    .name = "law", .couple = couple, .add_force = add_force, .add_jacobian = add_jacobian, .destroy = forget};
static const FemEffectOps law_with_floor = {.name = "law",
                                            .couple = couple,
                                            .prepare = prepare,
                                            .add_force = add_force,
                                            .add_jacobian = add_jacobian,
                                            .gap = gap,
                                            .destroy = forget};
static const FemEffectOps damper = {
    .name = "damping", .add_force = add_damper_force, .add_jacobian = add_damper_jacobian, .destroy = forget};

// What effects keep is memory of their own, which is weighed: a pointer to the toy.
static void add_effect(Toy *toy, const FemEffectOps *ops) {
  toy->system.effects[toy->system.effect_count++] =
      (FemEffect){.ops = ops, .self = memory_copy(&toy, 1, sizeof toy)};
}

// The model and system around a toy whose law is filled in; y and z are prescribed.
static void toy_open(Toy *toy) {
  static const char name[] = "chain";
  toy->body = (FemModelBody){.name = name, .vertex_end = toy->count};
  toy->scene = (FemSceneDef){.solver_tolerance = 1e-12, .threads = 1};
  for (int i = 0; i < toy->count; i++) {
    toy->rest[3 * i] = toy->count > 1 ? i : 0;
    toy->masses[i] = toy->mass;
    toy->unknown_of_dof[3 * i] = i, toy->unknown_of_dof[3 * i + 1] = toy->unknown_of_dof[3 * i + 2] = -1;
    toy->dof_of_unknown[i] = 3 * i;
  }
  toy->model = (FemModel){.scene = &toy->scene,
                          .vertex_count = toy->count,
                          .body_count = 1,
                          .rest = toy->rest,
                          .bodies = &toy->body,
                          .mass = toy->masses,
                          .unknown_count = toy->count,
                          .unknown_of_dof = toy->unknown_of_dof,
                          .dof_of_unknown = toy->dof_of_unknown};
  FemSystem *system = &toy->system;
  size_t dofs = 3 * (size_t)toy->count;
  *system = (FemSystem){.model = &toy->model,
                        .positions = memory_copy(toy->rest, dofs, sizeof(double)),
                        .velocities = memory_zeroed(dofs, sizeof(double)),
                        .forces = memory_zeroed(dofs, sizeof(double))};
  add_effect(toy, toy->floor_stiffness > 0 || toy->margin > 0 ? &law_with_floor : &law);
  if (toy->damper > 0) add_effect(toy, &damper);
  ck_assert_ok(fem_pattern_create(&system->pattern, toy->count));
  ck_assert_ok(couple(&toy, NULL, system->pattern, NULL));
  ck_assert_ok(fem_matrix_create(&system->matrix, system->pattern, toy->unknown_of_dof));
}

static FemIntegratorDef def_of(double tolerance, double end) {
  return (FemIntegratorDef){
      .displacement_tolerance = tolerance, .velocity_tolerance = tolerance, .max_order = 2, .end = end};
}

static FemIntegrator *start(Toy *toy, FemSolverKind kind, FemIntegratorDef def, const double *u,
                            const double *v) {
  FemIntegrator *integrator;
  ck_assert_ok(fem_integrator_create(&integrator, &toy->system, fem_solver_ops(kind), &def));
  ck_assert_ok(fem_integrator_restart(integrator, 0, u, v, 0));
  return integrator;
}

// Steps to the end; u, v (count) there.
static void finish(FemIntegrator *integrator, double end, int count, double *u, double *v) {
  double time = 0;
  bool is_onset;
  while (time < end) ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
  const double *u_end, *v_end;
  ck_assert(time == end);
  fem_integrator_state(integrator, &time, &u_end, &v_end);
  ck_assert(time == end);
  memcpy(u, u_end, (size_t)count * sizeof *u);
  memcpy(v, v_end, (size_t)count * sizeof *v);
}

START_TEST(free_fall_is_exact_but_for_the_first_steps) {
  Toy toy = {.count = 1, .mass = 2, .gravity = -9.81};
  toy_open(&toy);
  double u = 3, v = 4;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-7, 2), &u, &v);
  ck_assert_near(fem_integrator_acceleration(integrator)[0], -9.81, 1e-14);
  finish(integrator, 2, 1, &u, &v);
  ck_assert_near(u, 3 + 4 * 2 - 0.5 * 9.81 * 4, 5e-7);
  ck_assert_near(v, 4 - 9.81 * 2, 1e-9);
  FemIntegratorStats stats = fem_integrator_stats(integrator);
  ck_assert_int_lt((int)stats.steps, 60); // at order 2 nothing limits the step but max_step
  ck_assert_int_eq(stats.last_order, 2);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// Error at t = 1 of x = cos(10 t) with steps that only max_step limits.
static double oscillator_error(int max_order, double step) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  FemIntegratorDef def = def_of(1, 1); // loose: never refuses a step
  def.max_order = max_order;
  def.max_step = step;
  def.initial_step = max_order == 2 ? 0.01 * step : step;
  double u = 1, v = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def, &u, &v);
  finish(integrator, 1, 1, &u, &v);
  ck_assert_int_eq((int)fem_integrator_stats(integrator).error_test_failures, 0);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
  return fabs(u - cos(10.0));
}

START_TEST(an_oscillator_converges_with_the_order_of_the_method) {
  double first = oscillator_error(1, 2e-4) / oscillator_error(1, 1e-4);
  double second = oscillator_error(2, 2e-3) / oscillator_error(2, 1e-3);
  ck_assert_near(first, 2, 0.1);
  ck_assert_near(second, 4, 0.4);
}
END_TEST

START_TEST(an_oscillator_never_gains_energy) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  double u = 1, v = 0, time = 0, energy = 50;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-4, 10), &u, &v);
  bool is_onset;
  while (time < 10) {
    const double *u_now, *v_now;
    ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
    fem_integrator_state(integrator, &time, &u_now, &v_now);
    double now = 50 * u_now[0] * u_now[0] + 0.5 * v_now[0] * v_now[0];
    ck_assert_msg(now <= energy * (1 + 2e-5), "at t = %g the energy rose from %.9g to %.9g", time, energy,
                  now);
    energy = fmin(now, energy);
  }
  ck_assert(energy > 30); // and loses little
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// m ẍ + d ẋ + k x = 0, x(0) = 1, ẋ(0) = 0, by every solver.
START_TEST(a_damped_oscillator_decays_as_it_should) {
  double m = 2, k = 200, d = 4, end = 1.5;
  double decay = d / (2 * m), omega = sqrt(k / m - decay * decay);
  double exact = exp(-decay * end) * (cos(omega * end) + decay / omega * sin(omega * end));
  double exact_v = -exp(-decay * end) * (k / m) / omega * sin(omega * end);
  for (int s = 0; s < KIND_COUNT; s++) {
    Toy toy = {.count = 1, .mass = m, .wall_stiffness = k, .damper = d};
    toy_open(&toy);
    double u = 1, v = 0;
    FemIntegrator *integrator = start(&toy, KINDS[s], def_of(1e-7, end), &u, &v);
    finish(integrator, end, 1, &u, &v);
    ck_assert_near(u, exact, 2e-4);
    ck_assert_near(v, exact_v, 2e-3);
    FemIntegratorStats stats = fem_integrator_stats(integrator);
    ck_assert(stats.setups * 5 < stats.newton_iterations); // a set-up serves many steps
    ck_assert(stats.setups == fem_integrator_solver_stats(integrator)->factorisations);
    ck_assert_int_eq((int)fem_integrator_solver_stats(integrator)->analyses, 1);
    fem_integrator_destroy(integrator);
    fem_system_destroy(&toy.system);
  }
}
END_TEST

// Three masses between fixed ends: mode p has ω² = (2 k/m)(1 − cos(p π/4)) and shape sin(p π i/4).
START_TEST(a_chain_swings_in_its_modes) {
  const double pi = 3.14159265358979323846;
  for (int s = 0; s < KIND_COUNT; s++)
    for (int p = 1; p <= 3; p++) {
      Toy toy = {.count = 3, .mass = 0.5, .link_stiffness = 30};
      toy_open(&toy);
      double omega = sqrt(2 * 30 / 0.5 * (1 - cos(p * pi / 4))), u[3], v[3] = {0};
      for (int i = 0; i < 3; i++) u[i] = 0.01 * sin(p * pi * (i + 1) / 4);
      FemIntegrator *integrator = start(&toy, KINDS[s], def_of(1e-9, 1), u, v);
      finish(integrator, 1, 3, u, v);
      for (int i = 0; i < 3; i++) {
        double shape = 0.01 * sin(p * pi * (i + 1) / 4);
        ck_assert_near(u[i], shape * cos(omega), 3e-6 * omega);
        ck_assert_near(v[i], -shape * omega * sin(omega), 3e-6 * omega * omega);
      }
      fem_integrator_destroy(integrator);
      fem_system_destroy(&toy.system);
    }
}
END_TEST

// x = cos 10 t. As with contact lists, trial positions beyond a margin about the last accepted one are
// refused; without it the steps are longer.
START_TEST(a_refused_evaluation_changes_nothing_but_the_step) {
  const double margins[2] = {0, 0.01};
  long long steps[2];
  for (int k = 0; k < 2; k++) {
    Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100, .margin = margins[k], .accepted = 1};
    toy_open(&toy);
    double u = 1, v = 0, time = 0;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-5, 1), &u, &v);
    while (time < 1) {
      bool is_onset;
      const double *u_now, *v_now;
      ck_assert_ok(fem_system_accept(&toy.system, time, &u, &v, 0));
      ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
      fem_integrator_state(integrator, &time, &u_now, &v_now);
      u = u_now[0], v = v_now[0];
      ck_assert_near(u, cos(10 * time), 5e-3);
    }
    FemIntegratorStats stats = fem_integrator_stats(integrator);
    steps[k] = stats.steps;
    ck_assert((toy.retries > 10) == (k == 1));
    ck_assert(stats.newton_failures >= toy.retries);
    fem_integrator_destroy(integrator);
    fem_system_destroy(&toy.system);
  }
  ck_assert(steps[1] > steps[0]);
}
END_TEST

START_TEST(a_force_that_keeps_refusing_ends_the_run_with_its_reason) {
  Toy toy = {.count = 3, .mass = 1, .link_stiffness = 10, .broken_after = 0.5, .failure = STATUS_RETRY};
  toy_open(&toy);
  double u[3] = {0.1, 0, 0}, v[3] = {0}, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), u, v);
  bool is_onset;
  Status status;
  int steps = 0;
  while ((status = fem_integrator_step(integrator, &time, &is_onset)) == STATUS_OK)
    ck_assert_int_lt(++steps, 10000);
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert(time > 0.45 && time <= 0.5);
  ck_assert_ptr_nonnull(strstr(status_message(), "the force broke"));
  ck_assert_ptr_nonnull(strstr(status_message(), "of body 'chain'"));
  ck_assert_ptr_nonnull(strstr(status_message(), "max_step"));
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

START_TEST(a_fatal_force_comes_out_as_it_is) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 10, .broken_after = 0.5, .failure = STATUS_IO};
  toy_open(&toy);
  double u = 0.1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), &u, &v);
  bool is_onset;
  Status status;
  while ((status = fem_integrator_step(integrator, &time, &is_onset)) == STATUS_OK) ck_assert(time <= 0.5);
  ck_assert_int_eq(status, STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "the force broke"));
  ck_assert_int_eq(fem_integrator_step(integrator, &time, &is_onset), STATUS_SOLVER); // and stays so
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// A constant force towards x = 0 from both sides: no solution near x = 0 but rattling.
START_TEST(a_jump_of_the_force_never_hangs) {
  Toy toy = {.count = 1, .mass = 1, .friction = 1e3, .damper = 1};
  toy_open(&toy);
  double u = 0.1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 10), &u, &v);
  bool is_onset;
  Status status = STATUS_OK;
  long long steps = 0;
  while (time < 10 && (status = fem_integrator_step(integrator, &time, &is_onset)) == STATUS_OK)
    ck_assert_int_lt((int)++steps, 1000000);
  if (status != STATUS_OK) {
    ck_assert_int_eq(status, STATUS_SOLVER);
    ck_assert_ptr_nonnull(strstr(status_message(), "Worst: "));
    ck_assert_ptr_nonnull(strstr(status_message(), "Try "));
  }
  ck_assert(time > 0.01); // it got as far as the jump
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

START_TEST(a_run_that_crawls_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1e20}; // 10⁹ radians in the run
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-9, 1), &u, &v);
  bool is_onset;
  Status status;
  long long steps = 0;
  while ((status = fem_integrator_step(integrator, &time, &is_onset)) == STATUS_OK)
    ck_assert_int_lt((int)++steps, 3000);
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert(time < 1e-5);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// Whoever takes every other step back makes no way, however long the steps are.
START_TEST(a_run_whose_steps_are_taken_back_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 10};
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-4, 1), &u, &v);
  bool is_onset;
  Status status;
  long long steps = 0;
  while ((status = fem_integrator_step(integrator, &time, &is_onset)) == STATUS_OK) {
    ck_assert_int_lt((int)++steps, 3000);
    ck_assert_ok(fem_integrator_restart(integrator, 0, &u, &v, 0));
  }
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "stalls"));
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// Checkpoints and stages begin a new integrator long before a window of the stall is over.
START_TEST(a_crawl_through_many_integrators_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1e8};
  toy_open(&toy);
  FemStall stall = fem_stall_begin(0.5, 1, 1);
  FemIntegratorDef def = def_of(1e-9, 1);
  def.stall = &stall;
  double u = 1, v = 0, time = 0.5;
  Status status = STATUS_OK;
  for (int part = 0; part < 20 && status == STATUS_OK; part++) {
    FemIntegrator *integrator;
    ck_assert_ok(fem_integrator_create(&integrator, &toy.system, &fem_solver_cholmod, &def));
    ck_assert_ok(fem_integrator_restart(integrator, time, &u, &v, 0));
    bool is_onset;
    for (int k = 0; k < 300 && status == STATUS_OK; k++)
      status = fem_integrator_step(integrator, &time, &is_onset);
    const double *u_now, *v_now;
    fem_integrator_state(integrator, &time, &u_now, &v_now);
    u = *u_now, v = *v_now;
    fem_integrator_destroy(integrator);
  }
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "stalls") != NULL, "%s", status_message());
  ck_assert(time < 0.6);
  fem_system_destroy(&toy.system);
}
END_TEST

// ẍ = 10⁴ x: S = −10⁴ + c² is positive definite only for steps shorter than a hundredth.
START_TEST(a_matrix_that_is_not_positive_definite_shortens_the_step) {
  for (int s = 0; s < KIND_COUNT; s += 2) { // the condensed solvers
    Toy toy = {.count = 1, .mass = 1, .wall_stiffness = -1e4};
    toy_open(&toy);
    FemIntegratorDef def = def_of(1e-8, 0.06);
    def.initial_step = def.max_step = 0.03;
    double u = 1e-6, v = 1e-4;
    FemIntegrator *integrator = start(&toy, KINDS[s], def, &u, &v);
    finish(integrator, 0.06, 1, &u, &v);
    ck_assert_int_gt((int)fem_integrator_solver_stats(integrator)->failed_factorisations, 0);
    ck_assert_int_gt((int)fem_integrator_stats(integrator).newton_failures, 0);
    ck_assert_near(u, 1e-6 * exp(6), 2e-5);
    fem_integrator_destroy(integrator);
    fem_system_destroy(&toy.system);
  }
}
END_TEST

START_TEST(interpolation_meets_the_steps_and_keeps_to_the_last_one) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  const double *u_at, *v_at, *u_now, *v_now;
  double u = 1, v = 0, time = 0, before = 0, u_before = 1;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), &u, &v);
  bool is_onset;
  ck_assert_ok(fem_integrator_at(integrator, 0, &u_at, &v_at));
  ck_assert(u_at[0] == 1 && v_at[0] == 0);
  while (time < 1) {
    ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
    ck_assert_ok(fem_integrator_at(integrator, time, &u_at, &v_at));
    fem_integrator_state(integrator, &time, &u_now, &v_now);
    ck_assert(u_at[0] == u_now[0] && v_at[0] == v_now[0]);
    u = u_now[0];
    ck_assert_ok(fem_integrator_at(integrator, 0.5 * (before + time), &u_at, &v_at));
    ck_assert_near(u_at[0], cos(5 * (before + time)), 2e-3);
    ck_assert_ok(fem_integrator_at(integrator, before, &u_at, &v_at));
    ck_assert_near(u_at[0], u_before, 1e-4);
    before = time, u_before = u;
  }
  ck_assert_int_eq(fem_integrator_at(integrator, 0.5, &u_at, &v_at), STATUS_SOLVER);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// Goes on to t = 0.7, then back to t = 0.3 with the integrator's own arrays as source.
START_TEST(a_restart_from_an_earlier_state_repeats_the_run) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-7, 1), &u, &v);
  bool is_onset;
  while (time < 0.3) ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
  const double *u_now, *v_now;
  double kept_time;
  fem_integrator_state(integrator, &kept_time, &u_now, &v_now);
  double kept_u = u_now[0], kept_v = v_now[0];
  while (time < 0.7) ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
  FemIntegratorStats before = fem_integrator_stats(integrator);
  ck_assert_ok(fem_integrator_restart(integrator, kept_time, &kept_u, &kept_v, 1e-5));
  ck_assert_near(fem_integrator_acceleration(integrator)[0], -100 * kept_u, 1e-12);
  ck_assert_near(fem_integrator_stats(integrator).current_step, 1e-5, 0);
  ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
  ck_assert_near(time, kept_time + 1e-5, 1e-14);
  fem_integrator_state(integrator, &time, &u_now, &v_now);
  ck_assert_ok(fem_integrator_restart(integrator, time, u_now, v_now, 0)); // its own arrays
  finish(integrator, 1, 1, &u, &v);
  ck_assert_near(u, cos(10.0), 2e-4);
  FemIntegratorStats after = fem_integrator_stats(integrator);
  ck_assert_int_eq((int)after.restarts, 2);
  ck_assert(after.steps > before.steps && after.residuals > before.residuals);
  ck_assert(after.setups > before.setups);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// A ball falls from 1 m on a one-sided spring. With the onset found, a bounce gains no energy.
START_TEST(a_bouncing_ball_is_stopped_at_each_touch) {
  for (double stiffness = 1e4; stiffness <= 1e8; stiffness *= 100) {
    Toy toy = {.count = 1, .mass = 1, .gravity = -9.81, .floor_stiffness = stiffness};
    toy_open(&toy);
    double u = 1, v = 0, time = 0, highest_energy = 0, lowest = 1, end = 2, first_touch = 0;
    int touches = 0, steps = 0;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-5, end), &u, &v);
    ck_assert_ok(fem_system_accept(&toy.system, 0, &u, &v, 0));
    while (time < end) {
      bool is_onset;
      const double *u_now, *v_now;
      ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
      fem_integrator_state(integrator, &time, &u_now, &v_now);
      u = u_now[0], v = v_now[0];
      double spring = 0.5 * stiffness * fmin(u, 0) * fmin(u, 0);
      highest_energy = suite_larger(highest_energy, 0.5 * v * v + 9.81 * u + spring);
      lowest = fmin(lowest, u);
      ck_assert_int_lt(++steps, 20000);
      ck_assert_ok(fem_system_accept(&toy.system, time, &u, &v, 0));
      if (!is_onset) continue;
      touches++;
      if (first_touch == 0) first_touch = time;
      ck_assert(u <= 0 && u > -1e-6 && v < 0);
      ck_assert_ok(fem_integrator_restart(integrator, time, &u, &v, 0));
    }
    ck_assert_near(first_touch, sqrt(2 / 9.81), 1e-4);
    ck_assert_int_eq(touches, 2); // the second about 2 √(2h/g) after the first
    ck_assert_int_eq((int)fem_integrator_stats(integrator).roots, touches);
    ck_assert_near(lowest, -sqrt(2 * 9.81 / stiffness),
                   0.05 * sqrt(2 * 9.81 / stiffness) + 2 * 9.81 / stiffness);
    ck_assert_msg(highest_energy <= 9.81 * (1 + 1e-3), "gain %.3g at κ = %g", highest_energy / 9.81 - 1,
                  stiffness);
    fem_integrator_destroy(integrator);
    fem_system_destroy(&toy.system);
  }
}
END_TEST

START_TEST(an_onset_that_is_not_restarted_is_stepped_over) {
  Toy toy = {.count = 1, .mass = 1, .gravity = -9.81, .floor_stiffness = 100};
  toy_open(&toy);
  double u = 0.1, v = 0, time = 0, last = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-5, 0.25), &u, &v);
  ck_assert_ok(fem_system_accept(&toy.system, 0, &u, &v, 0));
  int touches = 0;
  while (time < 0.25) {
    bool is_onset;
    ck_assert_ok(fem_integrator_step(integrator, &time, &is_onset));
    ck_assert(time > last);
    last = time;
    touches += is_onset;
  }
  ck_assert_int_eq(touches, 1);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

START_TEST(what_makes_no_sense_is_refused) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1};
  toy_open(&toy);
  FemIntegratorDef good = def_of(1e-6, 1);
  FemIntegratorDef bad[6] = {good, good, good, good, good, good};
  bad[0].displacement_tolerance = 0;
  bad[1].velocity_tolerance = NAN;
  bad[2].end = -1;
  bad[3].max_step = 1e-3, bad[3].min_step = 1e-2;
  bad[4].max_order = 3;
  bad[5].initial_step = NAN;
  for (int k = 0; k < 6; k++) {
    FemIntegrator *integrator;
    ck_assert_int_eq(fem_integrator_create(&integrator, &toy.system, &fem_solver_cholmod, &bad[k]),
                     STATUS_INPUT);
    ck_assert_ptr_null(integrator);
  }
  FemIntegrator *integrator;
  double u = NAN, v = 0;
  ck_assert_ok(fem_integrator_create(&integrator, &toy.system, &fem_solver_cholmod, &good));
  ck_assert_int_eq(fem_integrator_restart(integrator, 0, &u, &v, 0), STATUS_SOLVER);
  fem_integrator_destroy(integrator);
  fem_system_destroy(&toy.system);
}
END_TEST

// A beam of tetrahedra under gravity, with damping.
typedef struct Beam {
  FemSceneDef scene;
  FemBodyDef body;
  FemConstraintDef fixed;
  FemModel model;
  FemSystem system;
} Beam;

static void beam_open(Beam *beam, double damping) {
  static char name[] = "beam";
  *beam = (Beam){0};
  beam->fixed = (FemConstraintDef){
      .select = {.kind = FEM_SELECT_BOX, .box_min = {-1, -1, -1}, .box_max = {1e-9, 2, 2}},
      .components = {true, true, true},
      .until = INFINITY,
  };
  beam->body = (FemBodyDef){.name = name,
                            .box_size = {1, 0.1, 0.1},
                            .box_cells = {20, 2, 2},
                            .placement = fem_mesh_placement_identity(),
                            .material = {.law = FEM_MATERIAL_NEO_HOOKEAN,
                                         .young = 1e6,
                                         .poisson = 0.3,
                                         .density = 1000,
                                         .damping = -1},
                            .fixed = &beam->fixed,
                            .fixed_count = 1};
  beam->scene = (FemSceneDef){.bodies = &beam->body,
                              .body_count = 1,
                              .has_gravity = true,
                              .gravity = {0, 0, -9.81},
                              .stiffness_damping = damping,
                              .solver_tolerance = 1e-8,
                              .threads = 1};
  ck_assert_ok(fem_model_create(&beam->model, &beam->scene));
  ck_assert_ok(fem_system_create(&beam->system, &beam->model));
}

static void beam_close(Beam *beam) {
  fem_system_destroy(&beam->system);
  fem_model_destroy(&beam->model);
}

START_TEST(all_solvers_bend_a_beam_alike) {
  for (int damped = 0; damped < 2; damped++) {
    double tip[KIND_COUNT];
    long long steps[KIND_COUNT];
    for (int s = 0; s < KIND_COUNT; s++) {
      Beam beam;
      beam_open(&beam, damped ? 5e-3 : 0);
      int n = beam.model.unknown_count;
      double *u = memory_zeroed((size_t)n, sizeof *u), *v = memory_zeroed((size_t)n, sizeof *v);
      FemIntegratorDef def = {
          .displacement_tolerance = 1e-5, .velocity_tolerance = 1e-3, .max_order = 2, .end = 0.1};
      FemIntegrator *integrator;
      ck_assert_ok(fem_integrator_create(&integrator, &beam.system, fem_solver_ops(KINDS[s]), &def));
      ck_assert_ok(fem_integrator_restart(integrator, 0, u, v, 0));
      finish(integrator, 0.1, n, u, v);
      tip[s] = 0;
      for (int i = 0; i < n; i++) tip[s] = fmin(tip[s], u[i]);
      steps[s] = fem_integrator_stats(integrator).steps;
      fem_integrator_destroy(integrator);
      beam_close(&beam);
      memory_free(u), memory_free(v);
    }
    ck_assert(tip[0] < -0.01); // free fall would be −0.049
    ck_assert_near(tip[1], tip[0], 1e-5);
    ck_assert_near(tip[2], tip[0], 1e-5);
    ck_assert(steps[1] == steps[0]); // the same Newton iterates but for rounding
  }
}
END_TEST

START_TEST(two_runs_have_the_same_bits) {
  double *result[2];
  int n = 0;
  for (int k = 0; k < 2; k++) {
    Beam beam;
    beam_open(&beam, 1e-3);
    n = beam.model.unknown_count;
    double *u = memory_zeroed((size_t)n, sizeof *u), *v = memory_zeroed((size_t)n, sizeof *v);
    FemIntegratorDef def = {
        .displacement_tolerance = 1e-4, .velocity_tolerance = 1e-2, .max_order = 2, .end = 0.05};
    FemIntegrator *integrator;
    ck_assert_ok(fem_integrator_create(&integrator, &beam.system, &fem_solver_cholmod, &def));
    ck_assert_ok(fem_integrator_restart(integrator, 0, u, v, 0));
    finish(integrator, 0.05, n, u, v);
    fem_integrator_destroy(integrator);
    beam_close(&beam);
    result[k] = u;
    memory_free(v);
  }
  ck_assert_mem_eq(result[0], result[1], (size_t)n * sizeof(double));
  memory_free(result[0]), memory_free(result[1]);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("integrator");
  tcase_add_test(cases, free_fall_is_exact_but_for_the_first_steps);
  tcase_add_test(cases, an_oscillator_converges_with_the_order_of_the_method);
  tcase_add_test(cases, an_oscillator_never_gains_energy);
  tcase_add_test(cases, a_damped_oscillator_decays_as_it_should);
  tcase_add_test(cases, a_chain_swings_in_its_modes);
  tcase_add_test(cases, a_refused_evaluation_changes_nothing_but_the_step);
  tcase_add_test(cases, a_force_that_keeps_refusing_ends_the_run_with_its_reason);
  tcase_add_test(cases, a_fatal_force_comes_out_as_it_is);
  tcase_add_test(cases, a_jump_of_the_force_never_hangs);
  tcase_add_test(cases, a_run_that_crawls_is_given_up);
  tcase_add_test(cases, a_run_whose_steps_are_taken_back_is_given_up);
  tcase_add_test(cases, a_crawl_through_many_integrators_is_given_up);
  tcase_add_test(cases, a_matrix_that_is_not_positive_definite_shortens_the_step);
  tcase_add_test(cases, interpolation_meets_the_steps_and_keeps_to_the_last_one);
  tcase_add_test(cases, a_restart_from_an_earlier_state_repeats_the_run);
  tcase_add_test(cases, a_bouncing_ball_is_stopped_at_each_touch);
  tcase_add_test(cases, an_onset_that_is_not_restarted_is_stepped_over);
  tcase_add_test(cases, what_makes_no_sense_is_refused);
  tcase_add_test(cases, all_solvers_bend_a_beam_alike);
  tcase_add_test(cases, two_runs_have_the_same_bits);
  return suite_run("integrator", cases, 60);
}
