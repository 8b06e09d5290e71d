// SPDX-License-Identifier: GPL-3.0-or-later
// Solids of quadratic tetrahedra in scenes: bending against theory and against exact solutions, loads,
// free fall, contact.
#include "static_solve.h"

#include <stdio.h>

#include "base/random.h"

static const char *const elements[] = {"linear", "quadratic"};

// Two elements through the thickness. Clamping hinders the sides' contraction, which beam theory leaves out:
// converged values are 0.991 at ν = 0.3 and 0.974 at 0.499.
START_TEST(two_elements_through_a_cantilever_are_enough) {
  static const double ratios[] = {0.3, 0.49, 0.499, 0.4999};
  for (int i = 0; i < 4; i++) {
    double quadratic = cantilever_deflection("quadratic", ratios[i], 2),
           linear = cantilever_deflection("linear", ratios[i], 2);
    printf("nu %g: quadratic %.4f, linear %.4f of beam theory\n", ratios[i], quadratic, linear);
    ck_assert_near(quadratic, 1, 0.05);
    ck_assert(linear < 0.75); // else the test would prove nothing
  }
}
END_TEST

// A bent state in equilibrium without forces inside, by Papkovich and Neuber: u = ∇(z ψ) − 4(1 − ν) ψ e_z
// with the harmonic ψ = exp(x) cos z. No polynomial: those up to the third degree come out exact at the
// vertices of a regular mesh, of linear elements too.
static void exact_bending(double nu, const double X[3], double u[3]) {
  double psi = exp(X[0]) * cos(X[2]), slope = -exp(X[0]) * sin(X[2]);
  u[0] = X[2] * psi;
  u[1] = 0;
  u[2] = psi + X[2] * slope - 4 * (1 - nu) * psi;
}

// The largest error at vertices over the largest displacement, the surface held where the solution has it.
static double bending_error(const char *element, double nu, int through) {
  const double scale = 1e-6;
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: beam\n"
           "    element: %s\n"
           "    mesh: {box: {size: [2, 0.5, 1], cells: [%d, %d, %d]}}\n"
           "    material: {law: linear, young: 1, poisson: %g, density: 1}\n"
           "    fixed: [{group: x_min}, {group: x_max}, {group: y_min}, {group: y_max}, {group: z_min}, "
           "{group: z_max}]\n",
           element, 2 * through, through / 2, through, nu);
  SceneRun run;
  scene_open_text(&run, text);
  FemSystem system;
  FemState state;
  void *solver;
  size_t n = (size_t)run.model.free_count;
  double *right = calloc(n, sizeof *right), *u = calloc(n, sizeof *u), error = 0, largest = 0, d[3];
  ck_assert_ok(fem_system_create(&system, &run.model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  for (int a = 0; a < run.model.vertex_count; a++) {
    exact_bending(nu, run.model.rest + 3 * a, d);
    for (int c = 0; c < 3; c++)
      state.positions[3 * a + c] =
          run.model.rest[3 * a + c] + (run.model.is_prescribed[3 * a + c] ? scale * d[c] : 0);
  }
  ck_assert_ok(fem_system_forces(&system, &state));
  for (size_t i = 0; i < n; i++) right[i] = system.forces[system.numbering.dof_of_unknown[i]];
  ck_assert_ok(fem_system_assemble(&system, &state, 1, 0, 0, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.create(&solver, 1, 1e-8));
  ck_assert_ok(fem_solver_cholmod.analyse(solver, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.factorise(solver, &system.matrix, NULL, NULL, 0));
  ck_assert_ok(fem_solver_cholmod.solve(solver, right, u));
  for (size_t i = 0; i < n; i++) {
    int dof = system.numbering.dof_of_unknown[i];
    exact_bending(nu, run.model.rest + (dof - dof % 3), d);
    error = suite_larger(error, fabs(u[i] - scale * d[dof % 3]));
    largest = fmax(largest, fabs(scale * d[dof % 3]));
  }
  fem_solver_cholmod.destroy(solver);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
  free(right);
  free(u);
  return error / largest;
}

// Order 3 in theory (more at vertices of this regular mesh); 2 where part of the pressure is constant in an
// element, as near ν = ½. Linear elements: 2, and next to nothing at 0.499.
START_TEST(displacements_converge_with_the_third_order) {
  static const double ratios[] = {0.3, 0.499}, least[] = {2.8, 1.9};
  for (int i = 0; i < 2; i++) {
    double order[2], fine[2];
    for (int k = 0; k < 2; k++) {
      double coarse = bending_error(elements[k], ratios[i], 4);
      fine[k] = bending_error(elements[k], ratios[i], 8);
      order[k] = log2(coarse / fine[k]);
      printf("nu %g, %s: errors %.3g, %.3g, order %.2f\n", ratios[i], elements[k], coarse, fine[k], order[k]);
    }
    ck_assert(order[1] > least[i]);
    ck_assert(order[0] < 2.1);
    ck_assert(fine[1] < 0.25 * fine[0]);
  }
}
END_TEST

// A bar pulled by a traction: with the integrals of the shape functions as loads the strain is uniform to
// rounding, whatever the node; shared like the areas of triangles it would not be.
START_TEST(a_uniform_traction_gives_a_uniform_strain) {
  SceneRun run;
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: bar\n"
           "    element: quadratic\n"
           "    mesh: {box: {size: [2, 1, 1], cells: [2, 2, 1]}}\n"
           "    material: {law: linear, young: 1, poisson: %g, density: 1}\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]}, {group: z_min, "
           "components: "
           "[z]}]\n"
           "    loads: [{group: x_max, traction: [1e-3, 0, 0]}]\n",
           _i ? 0.499 : 0.3);
  scene_open_text(&run, text);
  double *u = solve_linear_static(&run.model), nu = _i ? 0.499 : 0.3;
  for (int a = 0; a < run.model.vertex_count; a++)
    for (int c = 0; c < 3; c++)
      ck_assert_near(u[3 * a + c], (c == 0 ? 1e-3 : -1e-3 * nu) * run.model.rest[3 * a + c], 1e-13);
  free(u);
  scene_close(&run);
}
END_TEST

// Weight acts on the same lumped mass as inertia: a falling body is not strained. It would be by consistent
// weights, which lift the corners.
START_TEST(a_falling_body_stays_as_it_is) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 0.2, tolerance: 1e-8}\n"
                        "effects: {gravity: [0, 0, -10]}\n"
                        "bodies:\n"
                        "  - name: block\n"
                        "    element: quadratic\n"
                        "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 1}}\n"
                        "    material: {law: neo_hookean, young: 1e4, poisson: 0.45, density: 1000}\n"
                        "    velocity: [1, 0, 0]\n"
                        "output: {frames: 1}\n");
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  double mass = 0;
  for (int a = 0; a < run.model.vertex_count; a++) {
    const double *x = scene_position(&run, 1, a), *X = run.model.rest + 3 * a;
    ck_assert(run.model.mass[a] > 0);
    mass += run.model.mass[a];
    ck_assert_near(x[0], X[0] + 0.2, 1e-7);
    ck_assert_near(x[1], X[1], 1e-7);
    ck_assert_near(x[2], X[2] - 0.2, 1e-6); // IDA's tolerance
  }
  ck_assert_near(mass, 1, 1e-12);
  scene_close(&run);
}
END_TEST

// A twisted, pulled and bent block of large strain: the system's matrix against differences of its forces,
// damping and a following pressure included; every coordinate is free.
START_TEST(the_matrix_is_the_derivative_of_the_forces) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 1}\n"
                        "effects: {damping: 0.1}\n"
                        "bodies:\n"
                        "  - name: block\n"
                        "    element: quadratic\n"
                        "    mesh: {box: {size: [1, 1, 1], cells: 1}}\n"
                        "    material: {law: neo_hookean, young: 1, poisson: 0.49, density: 1}\n"
                        "    loads: [{all: true, pressure: 0.3}]\n"
                        "  - name: other\n" // a linear body beside it
                        "    mesh: {box: {size: [1, 1, 1], cells: 1}}\n"
                        "    place: {translate: [2, 0, 0]}\n"
                        "    material: {law: stvk, young: 1, poisson: 0.3, density: 1}\n");
  FemSystem system;
  FemState state;
  ck_assert_ok(fem_system_create(&system, &run.model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  int n = run.model.free_count;
  ck_assert_int_eq(n, 3 * (27 + 8));
  double *u = calloc((size_t)n, sizeof *u), *d = calloc((size_t)n, sizeof *d);
  double *Kd = calloc((size_t)n, sizeof *d), *above = calloc((size_t)n, sizeof *d), h = 1e-6;
  Random random = random_seeded(23, 0);
  for (int i = 0; i < n; i++) u[i] = 0.04 * suite_normal(&random), d[i] = suite_normal(&random);
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_assemble(&system, &state, 1, 0, 0, &system.matrix));
  fem_matrix_multiply(&system.matrix, d, Kd);
  for (int i = 0; i < n; i++) u[i] += h * d[i];
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_forces(&system, &state));
  memcpy(above, system.forces, (size_t)n * sizeof *above);
  for (int i = 0; i < n; i++) u[i] -= 2 * h * d[i];
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_forces(&system, &state));
  for (int i = 0; i < n; i++) ck_assert_near(Kd[i], -(above[i] - system.forces[i]) / (2 * h), 1e-7);
  double *all[] = {u, d, Kd, above};
  for (int i = 0; i < 4; i++) free(all[i]);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

// The area of a triangle of the lower block's top at these nodes, 0 elsewhere.
static double top_area(const SceneRun *run, int a, int b, int c) {
  const double *X = run->model.rest;
  if (X[3 * a + 2] != 0.05 || X[3 * b + 2] != 0.05 || X[3 * c + 2] != 0.05) return 0;
  return 0.5 * fabs((X[3 * b] - X[3 * a]) * (X[3 * c + 1] - X[3 * a + 1]) -
                    (X[3 * b + 1] - X[3 * a + 1]) * (X[3 * c] - X[3 * a]));
}

static double rise(const SceneRun *run, int a) {
  return scene_position(run, 1, a)[2] - run->model.rest[3 * a + 2];
}

// ∫ u_z over the top of the lower block: of a face of three vertices by them, of six nodes by its middles.
static double top_displacement(const SceneRun *run) {
  static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const FemModelBody *lower = &run->model.bodies[0];
  bool is_quadratic = lower->element == FEM_ELEMENT_QUADRATIC;
  double sum = 0;
  for (int e = lower->tet_begin; e < lower->tet_end && !is_quadratic; e++)
    for (int f = 0; f < 4; f++) {
      const int *tet = run->model.tets[e], *v = faces[f];
      double third = top_area(run, tet[v[0]], tet[v[1]], tet[v[2]]) / 3;
      sum += third * (rise(run, tet[v[0]]) + rise(run, tet[v[1]]) + rise(run, tet[v[2]]));
    }
  for (int e = lower->quadratic_begin; e < lower->quadratic_end; e++)
    for (int f = 0; f < 4; f++) {
      const int *nodes = run->model.quadratic_nodes[e], *v = faces[f];
      double third = top_area(run, nodes[v[0]], nodes[v[1]], nodes[v[2]]) / 3;
      for (int k = 0; k < 6 && third > 0; k++) // the middles of edges whose ends are both on top
        if (fem_quadratic_edges[k][0] != f && fem_quadratic_edges[k][1] != f)
          sum += third * rise(run, nodes[4 + k]);
    }
  return sum;
}

// Two blocks pressed together, each of its own element: what the load brings goes through the contact to the
// ground. However unevenly the vertices of the contact carry it, by Betti's theorem (against a uniform
// traction) the top of the lower block sinks by σ/E times its height, in the mean over the area; lateral
// forces of the contact are what remains.
START_TEST(a_press_of_blocks_carries_its_load) {
  static const char *const pairs[][2] = {{"quadratic", "quadratic"}, {"linear", "quadratic"}};
  char lower[64], upper[64];
  snprintf(lower, sizeof lower, "bodies.lower.element=%s", pairs[_i][0]);
  snprintf(upper, sizeof upper, "bodies.upper.element=%s", pairs[_i][1]);
  const char *overrides[] = {lower, upper, "bodies.lower.mesh.box.cells=[2,2,2]",
                             "bodies.upper.mesh.box.cells=[3,3,1]", NULL};
  SceneRun run;
  scene_run(&run, "patch", overrides);
  const double *force = scene_force(&run, 1, 0);
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  ck_assert_near(fabs(force[2]), 10, 1e-3); // 1000 Pa on 0.01 m²
  ck_assert_near(force[0], 0, 0.05);
  ck_assert_near(force[1], 0, 0.05);
  ck_assert_near(top_displacement(&run) / 0.01, -1e-3 * 0.05, 0.01 * 1e-3 * 0.05);
  scene_close(&run);
}
END_TEST

START_TEST(a_collision_keeps_momentum_and_energy) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 0.06, tolerance: 1e-6}\n"
                        "bodies:\n"
                        "  - name: left\n"
                        "    element: quadratic\n"
                        "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: [2, 1, 2]}}\n"
                        "    material: {law: neo_hookean, young: 1e6, poisson: 0.45, density: 1000}\n"
                        "    velocity: [1, 0, 0]\n"
                        "  - name: right\n"
                        "    element: quadratic\n"
                        "    mesh: {box: {size: [0.1, 0.12, 0.09], cells: 2}}\n"
                        "    place: {translate: [0.105, 0.02, 0.03]}\n"
                        "    material: {law: neo_hookean, young: 1e6, poisson: 0.45, density: 1000}\n"
                        "contact: {stiffness: 1e7, overlap: clip}\n"
                        "output: {frames: 4}\n");
  double before[3] = {0};
  for (int i = 0; i < 3 * run.model.vertex_count; i++)
    before[i % 3] += run.model.mass[i / 3] * run.model.initial_velocity[i];
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  ck_assert_near(before[0], 1, 1e-12);
  // The centre of mass goes on at the speed it had.
  double moved[3] = {0};
  for (int i = 0; i < 3 * run.model.vertex_count; i++)
    moved[i % 3] += run.model.mass[i / 3] * (scene_position(&run, 4, i / 3)[i % 3] - run.model.rest[i]);
  ck_assert_near(moved[0], 0.06, 1e-5);
  ck_assert_near(moved[1], 0, 1e-5);
  ck_assert_near(moved[2], 0, 1e-5);
  // It was hit: alone it would have stayed.
  ck_assert(scene_position(&run, 4, run.model.vertex_count - 1)[0] >
            run.model.rest[3 * (run.model.vertex_count - 1)] + 0.01);
  ck_assert(scene_gain(&run) < 1e-3);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("quadratic_solids");
  tcase_add_test(cases, two_elements_through_a_cantilever_are_enough);
  tcase_add_test(cases, displacements_converge_with_the_third_order);
  tcase_add_loop_test(cases, a_uniform_traction_gives_a_uniform_strain, 0, 2);
  tcase_add_test(cases, a_falling_body_stays_as_it_is);
  tcase_add_test(cases, the_matrix_is_the_derivative_of_the_forces);
  tcase_add_loop_test(cases, a_press_of_blocks_carries_its_load, 0, 2);
  tcase_add_test(cases, a_collision_keeps_momentum_and_energy);
  return suite_run("quadratic_solids", cases, 120);
}
