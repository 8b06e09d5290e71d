// SPDX-License-Identifier: GPL-3.0-or-later
// How many elements lie through the thickness of a body that bends, and what `tetlap check` says of it.
#include "scene.h"

#include <math.h>
#include <string.h>

#include "fem/model/compliance/thickness.h"

static FemThickness find_turned(const char *mesh, const char *place) {
  SceneRun run;
  char set[160];
  FemThickness thickness;
  snprintf(set, sizeof set, "bodies.block.mesh=%s", mesh);
  scene_open(&run, "free_fall", (const char *const[]){set, place, NULL});
  ck_assert_ok(fem_thickness_find(&run.model, 0, &thickness));
  scene_close(&run);
  return thickness;
}

static FemThickness find(const char *mesh) {
  return find_turned(mesh, NULL);
}

START_TEST(a_thin_plate_is_slender_and_its_layers_are_counted) {
  const char *const meshes[] = {"{box: {size: [0.2, 0.2, 0.01], cells: [6, 6, 1]}}",
                                "{box: {size: [0.2, 0.2, 0.01], cells: [6, 6, 2]}}",
                                "{box: {size: [0.2, 0.2, 0.01], cells: [6, 6, 4]}}"};
  const double layers[] = {1, 2, 4};
  for (int k = 0; k < 3; k++) {
    FemThickness thickness = find(meshes[k]);
    ck_assert(thickness.is_slender);
    ck_assert_near(thickness.thickness, 0.01, 1e-9);
    ck_assert_near(thickness.layers, layers[k], 1e-9);
  }
}
END_TEST

START_TEST(a_beam_is_slender_across) {
  FemThickness thickness = find("{box: {size: [0.5, 0.05, 0.05], cells: [20, 2, 2]}}");
  ck_assert(thickness.is_slender);
  ck_assert_near(thickness.thickness, 0.05, 1e-9);
  ck_assert_near(thickness.layers, 2, 1e-9);
}
END_TEST

// Along (1, 1, 1), where the box round it is shorter: 5.2 times as long as thick, and 4.8 times.
START_TEST(a_beam_is_as_slender_however_it_is_turned) {
  const char *const place = "bodies.block.place={rotate: {axis: [0, -1, 1], degrees: 54.7356}}";
  ck_assert(find_turned("{box: {size: [0.52, 0.1, 0.1], cells: [10, 2, 2]}}", place).is_slender);
  ck_assert(!find_turned("{box: {size: [0.48, 0.1, 0.1], cells: [10, 2, 2]}}", place).is_slender);
}
END_TEST

START_TEST(a_block_is_not_slender_however_coarse) {
  ck_assert(!find("{box: {size: [0.2, 0.2, 0.2], cells: 1}}").is_slender);
  ck_assert(!find("{box: {size: [0.2, 0.2, 0.1], cells: 2}}").is_slender);
}
END_TEST

// A cube of the edge 1 on a plate a twentieth as thick that goes on for this length.
static double wall_of_cube_and_plate(double length) {
  SceneRun run;
  FemThickness thickness;
  scene_open(&run, "free_fall",
             (const char *const[]){"bodies.block.mesh={box: {size: [12, 1, 1], cells: [12, 4, 4]}}", NULL});
  for (int v = 0; v < run.model.vertex_count; v++) {
    double *x = run.model.rest + 3 * (size_t)v, column = round(x[0]);
    x[0] = column < 6.5 ? column / 6 : 1.001 + (column - 7) / 5 * length;
    if (column > 6.5) x[2] *= 0.05;
  }
  ck_assert_ok(fem_thickness_find(&run.model, 0, &thickness));
  scene_close(&run);
  return thickness.wall;
}

// From less to more than half of the surface on the plate.
START_TEST(a_wall_has_no_jump_where_half_of_it_becomes_thin) {
  double before = wall_of_cube_and_plate(1), whole = before;
  for (int k = 1; k <= 60; k++) {
    double wall = wall_of_cube_and_plate(1 + 0.1 * k);
    ck_assert_double_lt(fabs(wall - before), 0.1 * whole);
    before = wall;
  }
  ck_assert_near(before, 0.05, 1e-3);
  ck_assert_double_gt(whole, 0.4);
}
END_TEST

// What `tetlap check` prints of the scene with that plate; owned by the caller.
static char *check_scene(const char *sets) {
  char command[1024], *text = NULL;
  size_t size = 0;
  snprintf(command, sizeof command, "%s check %s/tests/scenes/free_fall.yaml %s 2>&1", TETLAP_PROGRAM,
           TETLAP_SOURCE_DIR, sets);
  FILE *pipe = popen(command, "r"), *all = open_memstream(&text, &size);
  for (int c; (c = fgetc(pipe)) != EOF;) fputc(c, all);
  fclose(all);
  ck_assert_int_eq(pclose(pipe), 0);
  return text;
}

START_TEST(check_says_what_to_do_about_it) {
  const char *const plate = "--set 'bodies.block.mesh={box: {size: [0.2, 0.2, 0.01], cells: [6, 6, 1]}}'";
  char *thin = check_scene(plate), *block = check_scene(""), both[256];
  snprintf(both, sizeof both, "%s --set bodies.block.element=quadratic", plate);
  char *quadratic = check_scene(both);
  ck_assert_ptr_nonnull(strstr(thin, "'block' is slender, 0.01 m thick, and has about 1 "));
  ck_assert_ptr_nonnull(strstr(thin, "element: quadratic"));
  ck_assert_ptr_null(strstr(block, "slender"));
  ck_assert_ptr_null(strstr(quadratic, "slender"));
  free(thin), free(block), free(quadratic);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("thickness");
  tcase_add_test(cases, a_thin_plate_is_slender_and_its_layers_are_counted);
  tcase_add_test(cases, a_beam_is_slender_across);
  tcase_add_test(cases, a_beam_is_as_slender_however_it_is_turned);
  tcase_add_test(cases, a_block_is_not_slender_however_coarse);
  tcase_add_test(cases, a_wall_has_no_jump_where_half_of_it_becomes_thin);
  tcase_add_test(cases, check_says_what_to_do_about_it);
  return suite_run("thickness", cases, 30);
}
