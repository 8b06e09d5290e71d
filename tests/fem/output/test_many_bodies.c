// SPDX-License-Identifier: GPL-3.0-or-later
// history.csv of more pairs of bodies than a table has columns for: the force on each body.
#include "scene.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "folder.h"

// Cubes of 1 kg in a row, a little in the ground or, every third, on the one before it.
static void write_cubes(int count, char path[128]) {
  snprintf(path, 128, "%s/cubes.yaml", folder);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs("time: {end: 1, static: true}\nbodies:\n", file);
  for (int b = 0; b < count; b++)
    fprintf(
        file,
        "  - {name: cube_%d, mesh: {box: {size: [0.1, 0.1, 0.1], cells: 1}}, place: {translate: [%g, 0, "
        "%g]}, "
        "material: {young: 1e6, poisson: 0, density: 1000}, fixed: [{halfspace: {point: [0, 0, %g], normal: "
        "[0, 0, -1]}}]}\n",
        b, 0.2 * (b - (b % 3 == 2)), b % 3 == 2 ? 0.0998 : -0.0001, b % 3 == 2 ? 0.15 : 0.05);
  fputs("obstacles: [{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
        "contact: {stiffness: 1e6}\noutput: {frames: 1, vtu: false}\n",
        file);
  fclose(file);
}

static void run_cubes(SceneRun *run, int count) {
  char path[128];
  write_cubes(count, path);
  *run = (SceneRun){0};
  ck_assert_ok(app_scene_read(path, NULL, 0, &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
  FemRunOptions options = {.directory = folder};
  ck_assert_msg(fem_run(&run->model, &options, &run->result) == STATUS_OK, "%s", status_message());
}

// The number under a title in the last row; NAN: there is no such column.
static double told(char *text, const char *title) {
  char *lines[3] = {0}, *rest = NULL, *found = NULL, copy[1 << 16];
  int column = -1, count = 0;
  ck_assert_uint_lt(strlen(text), sizeof copy);
  strcpy(copy, text);
  for (char *line = strtok_r(copy, "\n", &rest); line && count < 3; line = strtok_r(NULL, "\n", &rest))
    lines[count++] = line;
  ck_assert_int_eq(count, 3);
  char *field = strtok_r(lines[0], ",", &rest);
  for (int c = 0; field && column < 0; c++, field = strtok_r(NULL, ",", &rest))
    if (strcmp(field, title) == 0) column = c;
  if (column < 0) return NAN;
  found = strtok_r(lines[2], ",", &rest);
  for (int c = 0; c < column; c++) found = strtok_r(NULL, ",", &rest);
  return strtod(found, NULL);
}

// One that lies on another presses it as much as it is pressed; the ground presses both in a row alike.
START_TEST(of_too_many_pairs_the_forces_on_bodies_are_told) {
  SceneRun run;
  run_cubes(&run, 60); // 1830 pairs with 10 columns each
  char *text = folder_read("history.csv");
  ck_assert(isnan(told(text, "force_cube_0_ground_z_N")));
  ck_assert(isnan(told(text, "moment_cube_0_ground_x_Nm")));
  double alone = told(text, "force_cube_0_z_N"), under = told(text, "force_cube_1_z_N"),
         above = told(text, "force_cube_2_z_N");
  ck_assert_double_gt(alone, 0.1);
  ck_assert_double_gt(above, 0.1);
  ck_assert_near(under, alone - above, 0.02 * alone); // the ground's and the upper cube's
  ck_assert_near(told(text, "force_cube_57_z_N"), alone, 1e-6 * alone);
  memory_free(text);
  scene_close(&run);
}
END_TEST

START_TEST(of_few_pairs_each_is_told) {
  SceneRun run;
  run_cubes(&run, 3);
  char *text = folder_read("history.csv");
  ck_assert_double_gt(told(text, "force_cube_0_ground_z_N"), 0.1);
  ck_assert(isnan(told(text, "force_cube_0_z_N")));
  memory_free(text);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("many_bodies");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, of_too_many_pairs_the_forces_on_bodies_are_told);
  tcase_add_test(cases, of_few_pairs_each_is_told);
  return suite_run("many_bodies", cases, 60);
}
