// SPDX-License-Identifier: GPL-3.0-or-later
// Work and precision: the same scene on another mesh, courses of runs whose meshes differ, the summary of
// many runs.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#include "app/compare/precision.h"
#include "app/scene/read.h"
#include "app/scene/refine.h"
#include "fem/model/build.h"
#include "lab/precision/summary.h"

enum { OUTPUT_SIZE = 1 << 16 };

static void read_text(const char *mesh, FemSceneDef *scene) {
  char text[1024];
  snprintf(text, sizeof text,
           "bodies:\n"
           "  - {name: left, mesh: {box: {size: [1, 1, 1], cells: [2, 3, 1]}},\n"
           "     material: {young: 1e5, poisson: 0.3, density: 1000}}\n"
           "  - {name: right, mesh: %s, place: {translate: [3, 0, 0]},\n"
           "     material: {young: 1e5, poisson: 0.3, density: 2000}}\n"
           "time: {end: 1}\n",
           mesh);
  ck_assert_ok(app_scene_read_text("(test)", text, strlen(text), scene));
}

START_TEST(a_level_multiplies_cells_and_divides_sizes) {
  FemSceneDef scene;
  read_text("{file: a.geo, size: 0.3}", &scene);
  ck_assert_ok(app_scene_refine(&scene, 1.5));
  ck_assert_int_eq(scene.bodies[0].box_cells[0], 3);
  ck_assert_int_eq(scene.bodies[0].box_cells[1], 5); // 4.5, rounded away from zero
  ck_assert_int_eq(scene.bodies[0].box_cells[2], 2);
  ck_assert_near(scene.bodies[1].mesh_options.size, 0.2, 1e-15);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_box_keeps_one_cell_at_least) {
  FemSceneDef scene;
  read_text("{box: {size: [1, 1, 1], cells: 2}}", &scene);
  ck_assert_ok(app_scene_refine(&scene, 0.1));
  for (int c = 0; c < 3; c++) ck_assert_int_eq(scene.bodies[0].box_cells[c], 1);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_mesh_of_fixed_size_has_no_other_level) {
  FemSceneDef scene;
  read_text("a.msh", &scene);
  ck_assert_ok(app_scene_refine(&scene, 1));
  ck_assert_int_eq(app_scene_refine(&scene, 2), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "'right'"));
  fem_scene_destroy(&scene);
}
END_TEST

// Two bodies of which each vertex moves alike: the course tells where, whatever the masses of the vertices.
START_TEST(a_course_follows_the_centres_of_mass) {
  FemSceneDef scene;
  FemModel model;
  read_text("{box: {size: [1, 1, 1], cells: 2}}", &scene);
  ck_assert_ok(fem_model_create(&model, &scene));
  size_t vertices = (size_t)model.vertex_count;
  double *trajectory = calloc(2 * vertices * 3, sizeof *trajectory), forces[6] = {0, 0, 0, 3, 0, 4};
  for (size_t f = 0; f < 2; f++)
    for (size_t i = 0; i < 3 * vertices; i++)
      trajectory[f * 3 * vertices + i] = model.rest[i] + (f == 1 && i % 3 == 2 ? 0.25 : 0);
  FemRunResult result = {.frame_count = 2,
                         .vertex_count = model.vertex_count,
                         .interface_count = 1,
                         .trajectory = trajectory,
                         .interface_forces = forces};
  AppPrecisionCourse course, other;
  ck_assert_ok(app_precision_course_create(&course, &model, &result));
  ck_assert_ok(app_precision_course_create(&other, &model, &result));
  ck_assert_int_eq(course.body_count, 2);
  const double centres[12] = {.5, .5, .5, 3.5, .5, .5, .5, .5, .75, 3.5, .5, .75};
  for (int i = 0; i < 12; i++) ck_assert_near(course.centres[i], centres[i], 1e-12);
  ck_assert_double_eq(app_precision_course_centre_error(&other, &course), 0);
  ck_assert_double_eq(app_precision_course_force_error(&other, &course), 0);
  other.centres[0] += 2; // one of four distances is 2: the mean square is 1
  other.forces[3] += 5;  // 5 off, of a force of 5
  ck_assert_near(app_precision_course_centre_error(&other, &course), 1, 1e-12);
  ck_assert_near(app_precision_course_force_error(&other, &course), 1, 1e-12);
  app_precision_course_destroy(&course), app_precision_course_destroy(&other);
  fem_model_destroy(&model), fem_scene_destroy(&scene);
  free(trajectory);
}
END_TEST

START_TEST(a_summary_takes_ratios_within_a_scene_and_a_tolerance) {
  const LabPrecisionRun runs[] = {
      {"a", "clip", 1, 1e-3, true, 100, 10, 200, 20, 2, 2, 0.5, 0.1, 0.1},
      {"a", "clip", 1, 1e-4, true, 400, 10, 800, 20, 8, 8, 0.5, 0.01, 0.01},
      {"b", "clip", 1, 1e-3, true, 1000, 80, 10, 20, 1, 1, 0.5, 0.1, 0.1},
      {"a", "geo", 1, 1e-3, true, 50, 0, 100, 10, 5, 5, 2, 0.2, 0.1},
      {"a", "geo", 1, 1e-4, true, 800, 30, 3200, 40, 20, 20, 5, 0.04, 0.01},
      {"b", "geo", 1, 1e-3, false, 7, 7, 7, 7, 7, 7, 7, NAN, NAN}, // counts as unfinished and nothing else
  };
  LabPrecisionSummary summary = lab_precision_summary_make("geo", "clip", runs, 6);
  ck_assert_int_eq((int)summary.pairs, 2);
  ck_assert_int_eq((int)summary.unfinished, 1);
  ck_assert_near(summary.steps, 1, 1e-12); // half and twice
  ck_assert_near(summary.steps_deviation, log(2), 1e-12);
  ck_assert_near(summary.steps_min, 0.5, 1e-12);
  ck_assert_near(summary.steps_max, 2, 1e-12);
  ck_assert_near(summary.newton, sqrt(0.5 * 4), 1e-12);
  ck_assert_near(summary.rejected, 30, 1e-12);
  ck_assert_near(summary.rejected_base, 20, 1e-12);
  ck_assert_near(summary.rejected_share, 30.0 / 850, 1e-12);
  ck_assert_near(summary.wall_rest, sqrt(3 / 1.5 * 15 / 7.5), 1e-12);
  ck_assert_near(summary.force_error, sqrt(2 * 4), 1e-12);
}
END_TEST

static double number_of(const char *row, const char *key) {
  char quoted[64];
  snprintf(quoted, sizeof quoted, "\"%s\":", key);
  const char *found = strstr(row, quoted);
  ck_assert_msg(found != NULL, "no %s in %s", quoted, row);
  return strtod(found + strlen(quoted), NULL);
}

// A block that meets the ground slanting: contact with pairs needs two bodies, so two blocks; the finer
// tolerance must be nearer to the reference, and the coarse mesh further from the finest one's.
START_TEST(errors_fall_with_the_tolerance_and_rows_carry_the_promised_keys) {
  static char output[OUTPUT_SIZE];
  char command[1024];
  snprintf(command, sizeof command,
           "cd '%s' && '%s' precision tests/scenes/collision.yaml --overlap clip,exact --level 1 "
           "--tolerance 3e-3,1e-4 --reference-tolerance 1e-5 --set time.end=0.03 --json 2>/dev/null",
           TETLAP_SOURCE_DIR, TETLAP_LAB);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, OUTPUT_SIZE - 1, pipe)] = 0;
  int ended = pclose(pipe);
  ck_assert(WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
  double path[4], force[4];
  int rows = 0, summaries = 0;
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n")) {
    if (strstr(row, "\"precision_summary\"")) {
      ck_assert_double_eq(number_of(row, "pairs"), 2);
      summaries++;
      continue;
    }
    ck_assert_int_lt(rows, 4);
    path[rows] = number_of(row, "trajectory_error"), force[rows] = number_of(row, "force_error");
    ck_assert_double_gt(number_of(row, "overlap_s"), 0); // there was contact
    ck_assert_double_gt(number_of(row, "steps"), 0);
    ck_assert_double_ge(number_of(row, "rejected"), number_of(row, "error_test_failures"));
    rows++;
  }
  ck_assert_int_eq(rows, 4);
  ck_assert_int_eq(summaries, 2);
  for (int m = 0; m < 4; m += 2) {
    ck_assert_double_gt(path[m + 1], 0);
    ck_assert_msg(path[m + 1] < 0.5 * path[m], "%g %g", path[m + 1], path[m]);
    ck_assert_msg(force[m + 1] < force[m], "%g %g", force[m + 1], force[m]);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("precision");
  tcase_add_test(cases, a_level_multiplies_cells_and_divides_sizes);
  tcase_add_test(cases, a_box_keeps_one_cell_at_least);
  tcase_add_test(cases, a_mesh_of_fixed_size_has_no_other_level);
  tcase_add_test(cases, a_course_follows_the_centres_of_mass);
  tcase_add_test(cases, a_summary_takes_ratios_within_a_scene_and_a_tolerance);
  tcase_add_test(cases, errors_fall_with_the_tolerance_and_rows_carry_the_promised_keys);
  return suite_run("precision", cases, 60);
}
