// SPDX-License-Identifier: GPL-3.0-or-later
// The energy with which bodies may strike, and the contact stiffness that is chosen for it.
#include "fem/model/compliance/blow.h"

#include <math.h>

#include "base/memory.h"
#include "fem/mesh/mesh.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/extent.h"
#include "fem/model/compliance/thickness.h"
#include "fem/model/parts.h"
#include "folder.h"
#include "medit.h"
#include "scene.h"

// tests/scenes/cubes.yaml: ten cubes of 0.1 m, E 1e5 Pa, 1 kg, the last one 10 kg; the first 0.01 m above the
// ground, each next 0.11 m higher.
enum { CUBES = 10, GROUND = 10 };
static const double G = 9.81, EDGE = 0.1, YOUNG = 1e5;

// With what one body strikes: all others weigh next to nothing.
static double energy_of(SceneRun *run, int body) {
  double masses[CUBES];
  for (int b = 0; b < CUBES; b++) {
    masses[b] = run->model.bodies[b].mass;
    if (b != body) run->model.bodies[b].mass *= 1e-12;
  }
  double energy = fem_blow_hardest(&run->model);
  for (int b = 0; b < CUBES; b++) run->model.bodies[b].mass = masses[b];
  return energy;
}

static void expect_near(double value, double expected) {
  ck_assert_near(value, expected, 1e-9 * expected);
}

START_TEST(a_body_strikes_with_what_it_falls) {
  SceneRun run;
  scene_open(&run, "cubes", NULL);
  for (int b = 0; b < CUBES; b++) expect_near(energy_of(&run, b), (b < 9 ? 1 : 10) * G * (0.01 + 0.11 * b));
  expect_near(fem_blow_hardest(&run.model), 10 * G);
  scene_close(&run);
}
END_TEST

START_TEST(it_falls_no_farther_than_until_the_end) {
  SceneRun run;
  scene_open(&run, "cubes", (const char *const[]){"time.end=0.1", NULL});
  expect_near(energy_of(&run, 0), G * 0.01);
  expect_near(energy_of(&run, 9), 10 * G * 0.5 * G * 0.01);
  scene_close(&run);
}
END_TEST

START_TEST(without_gravity_and_speed_nothing_strikes) {
  SceneRun run;
  scene_open(&run, "cubes", (const char *const[]){"effects.gravity=[0, 0, 0]", NULL});
  ck_assert(fem_blow_hardest(&run.model) == 0);
  scene_close(&run);
}
END_TEST

// Whichever of two moves, they can lose as much to each other, and no more.
START_TEST(two_that_float_strike_with_what_they_have_to_lose) {
  SceneRun run;
  scene_open(&run, "ring", NULL);
  double masses[2] = {run.model.bodies[0].mass, run.model.bodies[1].mass};
  expect_near(fem_blow_hardest(&run.model), 800 * masses[0] * masses[1] / (masses[0] + masses[1]));
  scene_close(&run);
  scene_open(
      &run, "ring",
      (const char *const[]){"bodies.ring.velocity=[3, 0, 60]", "bodies.spike.velocity=[3, 0, 20]", NULL});
  expect_near(fem_blow_hardest(&run.model), 800 * masses[0] * masses[1] / (masses[0] + masses[1]));
  scene_close(&run);
}
END_TEST

static double chosen(const SceneRun *run, int a, int b) {
  FemCompliance choice;
  ck_assert_ok(fem_compliance_choose(&run->model, &choice));
  double value = choice.stiffness[a * choice.party_count + b];
  fem_compliance_destroy(&choice);
  return value;
}

// What a cube that is held on two faces has in place of E.
static double held(const SceneRun *run) {
  double poisson = run->model.parts[0].material.poisson;
  ck_assert(poisson > 0.3);
  return YOUNG / (1 - 3.5 * pow(poisson, 4));
}

// p/(2c), how deep the blow presses.
START_TEST(a_blow_presses_the_interface_by_a_hundredth_of_the_height) {
  SceneRun run;
  double blow = 10 * G * 1, volume = EDGE * EDGE * EDGE, pressure = sqrt(2 * blow / (2 * volume / YOUNG));
  ck_assert(pressure > YOUNG / 2 && pressure < YOUNG);
  scene_open(&run, "cubes", NULL);
  expect_near(pressure / (2 * chosen(&run, 3, 9)), EDGE / 100);
  expect_near(pressure / (2 * chosen(&run, 4, 3)), EDGE / 100);
  pressure = sqrt(2 * blow / (volume / YOUNG)); // beyond E: p²/E
  ck_assert(pressure > YOUNG);
  expect_near(chosen(&run, 9, GROUND), 100 * pressure * pressure / YOUNG / EDGE);
  scene_close(&run);
}
END_TEST

// An edge as long as the body, which is the whole of it that touches, stores c L d³/3 against a half-space.
START_TEST(beyond_that_an_edge_holds_the_blow_within_a_quarter_of_the_height) {
  SceneRun run;
  scene_open(&run, "cubes", (const char *const[]){"effects.gravity=[0, 0, -98.1]", NULL});
  double blow = fem_blow_hardest(&run.model), stiffness = chosen(&run, 9, GROUND);
  expect_near(blow, 100 * G);
  double depth = cbrt(3 * blow / (stiffness * EDGE));
  ck_assert_near(depth, 0.25 * EDGE, 0.01 * EDGE);
  ck_assert_double_gt(chosen(&run, 3, 9), 50 * YOUNG / EDGE);
  scene_close(&run);
}
END_TEST

// From p = E on the second rule goes on where the first one ends.
START_TEST(the_stiffness_has_no_jump_where_the_pressure_is_e) {
  double around[2];
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char gravity[64];
    snprintf(gravity, sizeof gravity, "effects.gravity=[0, 0, %.9g]", -5 * (1 + (k ? 1e-6 : -1e-6)));
    scene_open(&run, "cubes", (const char *const[]){gravity, NULL}); // W = 10 kg · 5 m/s² · 1 m = E V / 2
    around[k] = chosen(&run, 9, GROUND);
    scene_close(&run);
  }
  ck_assert_near(around[1], around[0], 4e-6 * around[0]);
}
END_TEST

START_TEST(where_blows_are_light_the_press_decides) {
  SceneRun run;
  scene_open(&run, "cubes", (const char *const[]){"effects.gravity=[0, 0, -0.5]", NULL});
  expect_near(chosen(&run, 3, 9), 12.5 * held(&run) / EDGE);
  expect_near(chosen(&run, 3, GROUND), 50 * held(&run) / EDGE);
  scene_close(&run);
}
END_TEST

// A ring about y, .08 m wide inside and two elements thick, with a slit below: a box that is bent.
enum { ROUND = 24, ACROSS = 2, WIDE = 3 };
static const double THICK = 0.02;

static void write_ring(const char *path, double thick, double wide) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){1.96 * M_PI, thick, wide}, (int[]){ROUND, ACROSS, WIDE}));
  for (int v = 0; v < mesh.vertex_count; v++) {
    double *x = mesh.rest + 3 * (size_t)v, angle = x[0] - 0.48 * M_PI, radius = 0.08 + x[1];
    double place[3] = {radius * cos(angle), x[2] - wide / 2, radius * sin(angle)};
    memcpy(x, place, sizeof place);
  }
  medit_write(&mesh, path);
  fem_mesh_destroy(&mesh);
}

// Opens tests/scenes/ring.yaml with such a ring.
static void open_ring(SceneRun *run, double thick, double wide) {
  char path[128], mesh[160];
  snprintf(path, sizeof path, "%s/ring.mesh", folder);
  snprintf(mesh, sizeof mesh, "bodies.ring.mesh={file: %s}", path);
  write_ring(path, thick, wide);
  scene_open(run, "ring", (const char *const[]){mesh, NULL});
}

// What is hollow is crushed as a plate of its wall is: the height of the whole says nothing of that.
START_TEST(a_spike_does_not_pass_the_wall_of_a_ring) {
  SceneRun run;
  FemExtent extent;
  open_ring(&run, THICK, 0.05);
  double stored = 0, thick = THICK * cos(0.98 * M_PI / ROUND); // between facets
  for (int b = 0; b < 2; b++)
    stored += fem_model_parts_volume(&run.model, b) / run.model.parts[b].material.young;
  ck_assert_ok(fem_extent_measure(&run.model, 0, &extent));
  ck_assert_double_gt(extent.height, 2 * thick);
  double expected = 50 * 2 * fem_blow_hardest(&run.model) / stored / YOUNG / thick;
  ck_assert_near(chosen(&run, 0, 1), expected, 1e-6 * expected);
  scene_run_from(&run, NULL);
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), "finished");
  ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_PASSED].steps, 0);
  scene_close(&run);
}
END_TEST

// What an impact takes for the wall of a ring, and its height and length.
static double wall_of(double thick, FemExtent *extent) {
  SceneRun run;
  FemThickness found;
  open_ring(&run, thick, 0.2);
  ck_assert_ok(fem_extent_measure(&run.model, 0, extent));
  ck_assert_ok(fem_thickness_find(&run.model, 0, &found));
  ck_assert(found.is_slender == (found.wall < extent->length / 5));
  scene_close(&run);
  return found.wall;
}

START_TEST(from_a_thin_wall_to_a_thick_one_there_is_no_jump) {
  FemExtent extent;
  double last = 0;
  for (int k = 0; k < 20; k++) {
    double thick = 0.04 + 0.004 * k, wall = wall_of(thick, &extent);
    if (k > 0) ck_assert_double_lt(wall / last, 1.25);
    if (k > 0) ck_assert_double_ge(wall, last);
    last = wall;
  }
  ck_assert_near(wall_of(0.03, &extent), 0.03, 0.01 * 0.03);
  ck_assert_double_gt(extent.height, 2 * 0.03);
  ck_assert_double_eq(wall_of(0.15, &extent), extent.height);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("blow");
  tcase_add_test(cases, a_body_strikes_with_what_it_falls);
  tcase_add_test(cases, it_falls_no_farther_than_until_the_end);
  tcase_add_test(cases, without_gravity_and_speed_nothing_strikes);
  tcase_add_test(cases, two_that_float_strike_with_what_they_have_to_lose);
  tcase_add_test(cases, a_blow_presses_the_interface_by_a_hundredth_of_the_height);
  tcase_add_test(cases, beyond_that_an_edge_holds_the_blow_within_a_quarter_of_the_height);
  tcase_add_test(cases, the_stiffness_has_no_jump_where_the_pressure_is_e);
  tcase_add_test(cases, where_blows_are_light_the_press_decides);
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, a_spike_does_not_pass_the_wall_of_a_ring);
  tcase_add_test(cases, from_a_thin_wall_to_a_thick_one_there_is_no_jump);
  return suite_run("blow", cases, 30);
}
