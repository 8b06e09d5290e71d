// SPDX-License-Identifier: GPL-3.0-or-later
// tools/measure/frontier, precision and threads: that they measure what they say and write what plot and
// report read.
#include "folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "base/files/record.h"
#include "base/memory.h"

// The exit code; what is printed goes to the file `said` in the folder. −1: Python is not installed.
static int run_tool(const char *tool, const char *arguments) {
  char command[1024];
  if (system(TETLAP_PYTHON " -c pass 2>/dev/null") != 0) return -1;
  snprintf(command, sizeof command,
           "cd %s && " TETLAP_PYTHON " tools/measure/%s --program %s %s > %s/said 2>%s/errors",
           TETLAP_SOURCE_DIR, tool, TETLAP_PROGRAM, arguments, folder, folder);
  return WEXITSTATUS(system(command));
}

static const Record *find(const Record *points, const char *model, const char *quantity) {
  for (int k = 0; k < record_count(points); k++) {
    const Record *point = record_at(points, k);
    if (strcmp(record_find_text(point, "model"), model) == 0 &&
        strcmp(record_find_text(point, "quantity"), quantity) == 0)
      return point;
  }
  ck_abort_msg("no point %s %s", model, quantity);
  return NULL;
}

static double number_of(const Record *points, const char *model, const char *quantity, const char *key) {
  return record_find_number(find(points, model, quantity), key);
}

// Pairs and a scene: exact has no error, clip that of rounding, a learned model its own; what has no error is
// beaten by nothing.
START_TEST(the_frontier_has_every_model_s_error_and_time) {
  char arguments[256], path[128];
  Record *pareto;
  snprintf(arguments, sizeof arguments,
           "-m clip,exact,geo-small --pairs near -b 200 -r 1 --audit 2 -o %s/out "
           "examples/precision/edge.yaml",
           folder);
  int code = run_tool("frontier", arguments);
  if (code == -1) {
    suite_skip("python3 is not installed");
    return;
  }
  ck_assert_int_eq(code, 0);
  snprintf(path, sizeof path, "%s/out/pareto.json", folder);
  ck_assert_ok(record_read(&pareto, path));
  ck_assert_str_eq(record_find_text(pareto, "format"), "tetlap-pareto 1");
  const Record *points = record_find(pareto, "points");
  ck_assert_int_eq(record_count(points), 9);
  static const char *const quantities[] = {"V", "V+grad", "force"};
  for (int q = 0; q < 3; q++) {
    double rounding = number_of(points, q < 2 ? "clip" : "exact", quantities[q], "error");
    double learned = number_of(points, "geo-small", quantities[q], "error");
    ck_assert_double_eq(number_of(points, q < 2 ? "exact" : "clip", quantities[q], "error"), 0);
    ck_assert_msg(rounding < 1e-9, "%g", rounding);
    ck_assert_msg(learned > 1e-4 && learned < 0.2, "%g", learned);
    ck_assert_double_gt(number_of(points, "geo-small", quantities[q], "seconds_per_pair"), 0);
  }
  ck_assert_double_eq(number_of(points, "exact", "V", "frontier"), 1);
  ck_assert_double_gt(number_of(points, "geo-small", "force", "overlap_share"), 0);
  record_destroy(pareto);
  char *picture = folder_read("out/pareto.svg");
  ck_assert_ptr_nonnull(strstr(picture, ">geo-small<"));
  ck_assert_ptr_nonnull(strstr(picture, ">exact (no error)<"));
  ck_assert_ptr_nonnull(strstr(picture, "</svg>"));
  memory_free(picture);
}
END_TEST

// Errors fall with the tolerance.
START_TEST(precision_measures_errors_of_whole_runs) {
  double centres[2] = {0}, forces[2] = {0};
  int rows = 0, code = run_tool("precision", "-m clip -e 3e-3,1e-4 --reference-tolerance 1e-5 "
                                             "examples/precision/edge.yaml");
  if (code == -1) {
    suite_skip("python3 is not installed");
    return;
  }
  ck_assert_int_eq(code, 0);
  char *said = folder_read("said");
  for (char *line = strtok(said, "\n"); line; line = strtok(NULL, "\n"))
    if (rows < 2 && sscanf(line, "| edge | clip | %*g | %lf | %lf |", &centres[rows], &forces[rows]) == 2)
      rows++;
  memory_free(said);
  ck_assert_int_eq(rows, 2);
  ck_assert_msg(centres[1] > 0 && centres[1] < centres[0], "%g, %g", centres[0], centres[1]);
  ck_assert_msg(forces[1] > 0 && forces[1] < forces[0], "%g, %g", forces[0], forces[1]);
}
END_TEST

// Bodies that fall freely are soon done; each row has its number of threads, a time and a ratio.
START_TEST(threads_compares_runs_of_one_scene_by_threads) {
  char arguments[256];
  int rows = 0;
  snprintf(arguments, sizeof arguments,
           "--threads 1,3 --rounds 2 --plot %s/threads.svg 'tests/scenes/free_fall.yaml@output.frames=2'",
           folder);
  int code = run_tool("threads", arguments);
  if (code == -1) {
    suite_skip("python3 is not installed");
    return;
  }
  ck_assert_int_eq(code, 0);
  char *said = folder_read("said");
  for (char *line = strtok(said, "\n"); line; line = strtok(NULL, "\n")) {
    int threads;
    double wall, least, most, ratio;
    if (sscanf(line, "| free_fall@output.frames=2 | %d | %lf | %lf … %lf | %lf |", &threads, &wall, &least,
               &most, &ratio) != 5)
      continue;
    ck_assert_int_eq(threads, rows == 0 ? 1 : 3);
    ck_assert_msg(least <= wall && wall <= most && ratio > 0, "%s", line);
    rows++;
  }
  memory_free(said);
  ck_assert_int_eq(rows, 2);
  char *picture = folder_read("threads.svg");
  ck_assert_ptr_nonnull(strstr(picture, "free_fall, 3</text>"));
  ck_assert_ptr_nonnull(strstr(picture, "</svg>"));
  memory_free(picture);
}
END_TEST

// A setting that the scene does not know: the program's message is told, not a table.
START_TEST(threads_tells_why_a_run_failed) {
  int code = run_tool("threads", "--rounds 1 'tests/scenes/free_fall.yaml@time.nonsense=1'");
  if (code == -1) {
    suite_skip("python3 is not installed");
    return;
  }
  ck_assert_int_eq(code, 1);
  char *errors = folder_read("errors");
  ck_assert_ptr_nonnull(strstr(errors, "nonsense"));
  memory_free(errors);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("measure");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, the_frontier_has_every_model_s_error_and_time);
  tcase_add_test(cases, precision_measures_errors_of_whole_runs);
  tcase_add_test(cases, threads_compares_runs_of_one_scene_by_threads);
  tcase_add_test(cases, threads_tells_why_a_run_failed);
  return suite_run("measure", cases, 120);
}
