// SPDX-License-Identifier: GPL-3.0-or-later
// Lines through bodies: what a run writes of them is what a hand computes.
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "folder.h"

enum { NUMBERS = 16 };
enum { TIME, WAY, X, Z = X + 2, MOVED_X, MOVED_Z = MOVED_X + 2, STRESS_ZZ = MOVED_Z + 3, PRESSURE = 15 };

// The rows of a line in a file of the folder; how many.
static int read_line(const char *file, const char *name, double (*rows)[NUMBERS], int most) {
  int count = 0;
  char *text = folder_read(file), *rest = NULL;
  for (char *row = strtok_r(text, "\n", &rest); row; row = strtok_r(NULL, "\n", &rest)) {
    const size_t length = strlen(name);
    if (strncmp(row, name, length) != 0 || row[length] != ',') continue;
    ck_assert_int_lt(count, most);
    char *at = row + length;
    for (int k = 0; k < NUMBERS; k++) {
      ck_assert_int_eq(*at, ',');
      rows[count][k] = strtod(at + 1, &at);
    }
    ck_assert_int_eq(*at, 0);
    count++;
  }
  memory_free(text);
  return count;
}

static void run_into_folder(SceneRun *run, const char *name, const char *const *overrides) {
  scene_open(run, name, overrides);
  FemRunOptions options = {.directory = folder};
  ck_assert_msg(fem_run(&run->model, &options, &run->result) == STATUS_OK, "%s", status_message());
}

// Two blocks of E = 1 MPa, 5 cm high, pressed by 1000 Pa: a strain of 0.1 %, the interface gives p / (2 c).
START_TEST(a_pressed_block_shows_its_stress_strain_and_pressure_along_lines) {
  SceneRun run;
  double rows[8][NUMBERS];
  run_into_folder(
      &run, "patch",
      (const char *const[]){
          "bodies.upper.lines=[{name: up, from: [0.04, 0.06, 0.05], to: [0.04, 0.06, 0.1], points: "
          "6}, {name: sole, from: [0, 0.03, 0.05], to: [0.1, 0.03, 0.05], points: 5}]",
          "output.vtu=false", NULL});
  ck_assert_int_eq(read_line("lines_00000.csv", "up", rows, 8), 6);
  for (int k = 0; k < 6; k++) ck_assert_near(rows[k][MOVED_Z], 0, 1e-15);
  ck_assert_int_eq(read_line("lines_00001.csv", "up", rows, 8), 6);
  const double foot = -0.05e-3 - 1000 / (2 * 2e7);
  for (int k = 0; k < 6; k++) {
    ck_assert_double_eq(rows[k][TIME], 1);
    ck_assert_near(rows[k][WAY], 0.01 * k, 1e-12);
    ck_assert_near(rows[k][MOVED_Z], foot - 1e-3 * rows[k][WAY], 1e-6);        // the interface's share: 1 %
    ck_assert_near(rows[k][Z], 0.05 + rows[k][WAY] + rows[k][MOVED_Z], 1e-10); // ten digits
    ck_assert_near(rows[k][MOVED_X], 0.3 * 1e-3 * 0.04, 1e-7);
    ck_assert_near(rows[k][STRESS_ZZ], -1000, 5);
    if (k > 0 && k < 5) ck_assert(isnan(rows[k][PRESSURE])); // within
  }
  ck_assert_near(rows[5][PRESSURE], 0, 1e-9); // free of contact
  ck_assert_int_eq(read_line("lines_00001.csv", "sole", rows, 8), 5);
  for (int k = 0; k < 5; k++) ck_assert_near(rows[k][PRESSURE], 1000, 10);
  scene_close(&run);
}
END_TEST

// A point that is a third of an edge above the block has no place; one that is nearer is on its surface.
START_TEST(points_near_the_surface_are_on_it_and_others_left_out) {
  SceneRun run;
  scene_open(
      &run, "patch",
      (const char *const[]){"bodies.upper.lines=[{name: out, from: [0.05, 0.05, 0.09], to: [0.05, 0.05, "
                            "0.13], points: 9}]",
                            NULL});
  const FemLine *line = &run.model.lines[0];
  ck_assert_int_eq(line->count, 4); // z = .09, .095, .1, .105
  ck_assert(!line->points[1].is_surface && line->points[2].is_surface && line->points[3].is_surface);
  for (int k = 0; k < line->count; k++) {
    const int *corners = run.model.tets[line->points[k].tet];
    double z = 0;
    for (int v = 0; v < 4; v++) z += line->points[k].shares[v] * run.model.rest[3 * corners[v] + 2];
    ck_assert_near(z, fmin(0.1, 0.09 + line->points[k].way), 1e-12);
    ck_assert(run.model.tet_body[line->points[k].tet] == 1);
  }
  scene_close(&run);
}
END_TEST

// Through the block from corner to corner and as far again at both ends, at 10,000 places: shares between 0
// and 1 make up each place within.
START_TEST(elements_carry_each_point_of_a_slanting_line) {
  SceneRun run;
  const double from[3] = {-0.1, -0.1, 0}, way[3] = {0.3, 0.3, 0.15}, whole = sqrt(0.2025);
  scene_open(&run, "patch",
             (const char *const[]){"bodies.upper.lines=[{name: slant, from: [-0.1, -0.1, 0], to: [0.2, 0.2, "
                                   "0.15], points: 10000}]",
                                   NULL});
  const FemLine *line = &run.model.lines[0];
  int within = 0;
  for (int k = 0; k < line->count; k++) {
    const FemLinePoint *point = &line->points[k];
    const double share = point->way / whole;
    if (share < 1 / 3.0 - 1e-9 || share > 2 / 3.0 + 1e-9) continue;
    for (int c = 0; c < 3; c++) {
      double place = 0;
      for (int v = 0; v < 4; v++)
        place += point->shares[v] * run.model.rest[3 * run.model.tets[point->tet][v] + c];
      ck_assert_near(place, from[c] + share * way[c], 1e-12);
    }
    for (int v = 0; v < 4; v++) ck_assert(point->shares[v] > -1e-9 && point->shares[v] < 1 + 1e-9);
    within++;
  }
  ck_assert_int_eq(within, 3334); // 3333 to 6666
  scene_close(&run);
}
END_TEST

START_TEST(lines_that_cannot_be_are_refused_with_their_place) {
  static const struct {
    const char *lines, *message;
  } cases[] = {
      {"[{name: far, from: [5, 5, 5], to: [6, 6, 6]}]", "line 'far': none of its 51 points is in the body"},
      {"[{name: dot, from: [0, 0, 0], to: [0, 0, 0]}]", "line 'dot': from and to are 0 m apart"},
      {"[{name: long, from: [1e300, 0, 0], to: [-1e300, 0, 0]}]", "line 'long': from and to are inf m apart"},
      {"[{name: a, from: [0, 0, 0], to: [0.1, 0, 0]}, {name: a, from: [0, 0, 0], to: [0, 0.1, 0]}]",
       "line 'a': there is another line of that name"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    FemSceneDef scene;
    FemModel model;
    char override[256];
    const char *const overrides[] = {override};
    snprintf(override, sizeof override, "bodies.lower.lines=%s", cases[k].lines);
    ck_assert_ok(app_scene_read(TETLAP_SOURCE_DIR "/tests/scenes/patch.yaml", overrides, 1, &scene));
    ck_assert_int_eq(fem_model_create(&model, &scene), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), cases[k].message) != NULL, "%s", status_message());
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(a_run_takes_away_the_lines_of_an_earlier_one) {
  SceneRun run;
  char path[128];
  run_into_folder(&run, "patch",
                  (const char *const[]){"bodies.upper.lines=[{name: up, from: [0.04, 0.06, 0.05], to: [0.04, "
                                        "0.06, 0.1]}]",
                                        "output.frames=2", NULL});
  scene_close(&run);
  snprintf(path, sizeof path, "%s/lines_00002.csv", folder);
  ck_assert_int_eq(access(path, F_OK), 0);
  run_into_folder(&run, "patch", NULL);
  scene_close(&run);
  ck_assert_int_ne(access(path, F_OK), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("lines");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, a_pressed_block_shows_its_stress_strain_and_pressure_along_lines);
  tcase_add_test(cases, points_near_the_surface_are_on_it_and_others_left_out);
  tcase_add_test(cases, elements_carry_each_point_of_a_slanting_line);
  tcase_add_test(cases, lines_that_cannot_be_are_refused_with_their_place);
  tcase_add_test(cases, a_run_takes_away_the_lines_of_an_earlier_one);
  return suite_run("lines", cases, 60);
}
