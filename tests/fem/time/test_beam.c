// SPDX-License-Identifier: GPL-3.0-or-later
// fem/time/integrator.h on a beam of tetrahedra: every solver alike, and the same bits twice.
#include "toy.h"

// A beam of tetrahedra under gravity, with damping.
typedef struct Beam {
  FemSceneDef scene;
  FemBodyDef body;
  FemConstraintDef fixed;
  FemModel model;
  FemSystem system;
  FemState state; // under trial
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
                            .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
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
  ck_assert_ok(fem_system_create_state(&beam->system, &beam->state));
}

static void beam_close(Beam *beam) {
  fem_state_destroy(&beam->state);
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
      int n = beam.model.free_count;
      double *u = memory_zeroed((size_t)n, sizeof *u), *v = memory_zeroed((size_t)n, sizeof *v);
      FemIntegratorDef def = {
          .displacement_tolerance = 1e-5, .velocity_tolerance = 1e-3, .max_order = 2, .end = 0.1};
      FemIntegrator *integrator;
      ck_assert_ok(
          fem_integrator_create(&integrator, &beam.system, &beam.state, fem_solver_ops(KINDS[s]), &def));
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
    n = beam.model.free_count;
    double *u = memory_zeroed((size_t)n, sizeof *u), *v = memory_zeroed((size_t)n, sizeof *v);
    FemIntegratorDef def = {
        .displacement_tolerance = 1e-4, .velocity_tolerance = 1e-2, .max_order = 2, .end = 0.05};
    FemIntegrator *integrator;
    ck_assert_ok(fem_integrator_create(&integrator, &beam.system, &beam.state, &fem_solver_cholmod, &def));
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
  TCase *cases = tcase_create("beam");
  tcase_add_test(cases, all_solvers_bend_a_beam_alike);
  tcase_add_test(cases, two_runs_have_the_same_bits);
  return suite_run("beam", cases, 60);
}
