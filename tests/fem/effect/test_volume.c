// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that do not lock: patch test, derivatives, and a cantilever up to ν = 0.499.
#include "static_solve.h"

#include <stdio.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/effect/elements/volume.h"
#include "fem/effect/system_energy.h"
#include "reference/material.h"

static const char *const laws[] = {"linear", "corotational", "stvk", "neo_hookean"};
enum { LAW_COUNT = sizeof laws / sizeof *laws };

static void open_block(SceneRun *run, const char *law, const char *element) {
  char text[512];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: block\n"
           "    element: %s\n"
           "    mesh: {box: {size: [1, 1, 1], cells: [2, 1, 2]}}\n"
           "    material: {law: %s, young: 1, poisson: 0.49, density: 1}\n",
           element, law);
  scene_open_text(run, text);
}

static double energy_at(FemVolume *volume, const double *x) {
  fem_volume_evaluate(volume, x);
  return fem_volume_energy(volume);
}

// Central differences of a smooth energy of size 10: h²/6 ≈ 1e-11 and rounding 1e-15·10/h = 1e-9.
START_TEST(force_and_stiffness_are_derivatives_of_the_energy) {
  SceneRun run;
  open_block(&run, laws[_i], "nodal");
  FemVolume volume;
  FemSystem system;
  ck_assert_ok(fem_volume_create(&volume, &run.model));
  ck_assert_ok(fem_system_create(&system, &run.model));
  int n = 3 * run.model.vertex_count;
  Random random = random_seeded(11, (uint64_t)_i);
  double *x = calloc((size_t)n, sizeof *x), *force = calloc((size_t)n, sizeof *x), h = 1e-5;
  double *d = calloc((size_t)n, sizeof *x), *Kd = calloc((size_t)n, sizeof *x);
  double *above = calloc((size_t)n, sizeof *x), *below = calloc((size_t)n, sizeof *x);
  for (int i = 0; i < n; i++) x[i] = run.model.rest[i] + 0.06 * suite_normal(&random);
  for (int i = 0; i < n; i++) d[i] = suite_normal(&random);
  fem_volume_evaluate(&volume, x);
  fem_volume_add_force(&volume, force);
  for (int i = 0; i < n; i++) {
    double here = x[i];
    x[i] = here + h;
    double high = energy_at(&volume, x);
    x[i] = here - h;
    double low = energy_at(&volume, x);
    x[i] = here;
    ck_assert_near(force[i], -(high - low) / (2 * h), 1e-7);
  }
  fem_volume_evaluate(&volume, x);
  fem_matrix_zero(&system.matrix);
  fem_volume_add_stiffness(&volume, x, 1, &system.matrix);
  fem_matrix_multiply(&system.matrix, d, Kd); // nothing is fixed: unknowns are coordinates
  for (int i = 0; i < n; i++) x[i] += h * d[i];
  fem_volume_evaluate(&volume, x);
  fem_volume_add_force(&volume, above);
  for (int i = 0; i < n; i++) x[i] -= 2 * h * d[i];
  fem_volume_evaluate(&volume, x);
  fem_volume_add_force(&volume, below);
  for (int i = 0; i < n; i++) ck_assert_near(Kd[i], -(above[i] - below[i]) / (2 * h), 1e-6);
  double *all[] = {x, force, d, Kd, above, below};
  for (int i = 0; i < 6; i++) free(all[i]);
  fem_volume_destroy(&volume);
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

// A ball of irregular tetrahedra.
static void open_ball(SceneRun *run, const char *law, const char *element) {
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: ball\n"
           "    element: %s\n"
           "    mesh: {file: \"%s/meshes/sphere.msh\"}\n"
           "    place: {scale: 10}\n"
           "    material: {law: %s, young: 1, poisson: 0.49, density: 1}\n",
           element, TETLAP_SOURCE_DIR, law);
  scene_open_text(run, text);
}

static void mark_surface(const FemModel *model, bool *on_surface) {
  FemMesh mesh = {.vertex_count = model->vertex_count,
                  .tet_count = model->tet_count,
                  .rest = model->rest,
                  .tets = model->tets};
  int(*triangles)[3], count;
  ck_assert_ok(fem_mesh_surface(&mesh, &triangles, &count));
  for (int t = 0; t < count; t++)
    for (int i = 0; i < 3; i++) on_surface[triangles[t][i]] = true;
  memory_free(triangles);
}

// x = F X: every element of a linear field has the same θ, so averaging changes nothing: inner forces vanish
// on an irregular mesh, and the energy is that of the law.
START_TEST(a_linear_field_passes_the_patch_test) {
  static const double F[9] = {1.05, 0.02, -0.03, 0.01, 0.97, 0.04, 0.02, 0, 1.02};
  static const char *const elements[] = {"linear", "nodal", "quadratic"};
  SceneRun run;
  open_ball(&run, laws[_i % LAW_COUNT], elements[_i / LAW_COUNT]);
  const FemModel *model = &run.model;
  FemSystem system;
  FemState state;
  FemEnergy energy;
  ck_assert_ok(fem_system_create(&system, model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  ck_assert_int_eq(fem_system_effect(&system, &fem_effect_volume) != NULL, _i / LAW_COUNT == 1);
  bool *on_surface = calloc((size_t)model->vertex_count, sizeof *on_surface);
  mark_surface(model, on_surface);
  for (int a = 0; a < model->vertex_count; a++)
    for (int i = 0; i < 3; i++)
      state.positions[3 * a + i] = F[3 * i] * model->rest[3 * a] + F[3 * i + 1] * model->rest[3 * a + 1] +
                                   F[3 * i + 2] * model->rest[3 * a + 2];
  ck_assert_ok(fem_system_energy(&system, &state, &energy));
  double volume = model->bodies[0].mass;
  ck_assert_near(energy.elastic, volume * reference_energy(&model->parts[0].material, F), 1e-12 * volume);
  // The forces are those of the stress on the surface: Σ −f X_x = V P e_x.
  double P[9], sum[3] = {0};
  int inside = 0;
  ck_assert_ok(fem_system_forces(&system, &state));
  fem_material_stress(&model->parts[0].material, F, P);
  for (int a = 0; a < model->vertex_count; a++) {
    inside += !on_surface[a];
    for (int c = 0; c < 3; c++) {
      if (!on_surface[a]) ck_assert_near(system.forces[3 * a + c], 0, 1e-13);
      sum[c] -= system.forces[3 * a + c] * model->rest[3 * a];
    }
  }
  ck_assert_int_gt(inside, 30);
  for (int c = 0; c < 3; c++) ck_assert_near(sum[c], volume * P[3 * c], 1e-12 * volume);
  free(on_surface);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

START_TEST(at_small_poisson_ratios_nothing_is_left_for_the_vertices) {
  FemMaterial material = {.young = 2, .poisson = 0.2};
  FemMaterial local = fem_material_local(&material);
  ck_assert_double_eq(local.young, 2);
  ck_assert_double_eq(local.poisson, 0.2);
  material.poisson = 0.499;
  local = fem_material_local(&material);
  ck_assert_near(local.poisson, 0.25, 1e-15);
  ck_assert_near(fem_material_lame(&local).mu, fem_material_lame(&material).mu, 1e-15);
}
END_TEST

START_TEST(a_cantilever_bends_within_10_percent_of_beam_theory) {
  static const double ratios[] = {0.3, 0.49, 0.499};
  for (int i = 0; i < 3; i++) {
    double nodal = cantilever_deflection("nodal", ratios[i], 10),
           linear = cantilever_deflection("linear", ratios[i], 10);
    printf("nu %g: nodal %.4f, linear %.4f of beam theory\n", ratios[i], nodal, linear);
    ck_assert_near(nodal, 1, 0.1);
    if (ratios[i] > 0.45) ck_assert(linear < 0.9); // else the test would prove nothing
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("volume");
  tcase_add_loop_test(test_case, force_and_stiffness_are_derivatives_of_the_energy, 0, LAW_COUNT);
  tcase_add_loop_test(test_case, a_linear_field_passes_the_patch_test, 0, 3 * LAW_COUNT);
  tcase_add_test(test_case, at_small_poisson_ratios_nothing_is_left_for_the_vertices);
  tcase_add_test(test_case, a_cantilever_bends_within_10_percent_of_beam_theory);
  return suite_run("volume", test_case, 120);
}
