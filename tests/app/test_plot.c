// SPDX-License-Identifier: GPL-3.0-or-later
// app/plot: the scripts hold every curve and every point, labels keep apart, gnuplot draws them.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/plot/gnuplot.h"
#include "app/plot/plot.h"
#include "base/files/file.h"
#include "base/memory.h"

enum { MODELS = 12 };

static char picture[80], script[96];

static void name_files(void) {
  snprintf(picture, sizeof picture, "/tmp/tetlap_plot_%ld.svg", (long)getpid());
  snprintf(script, sizeof script, "%s.gp", picture);
}

static void remove_files(void) {
  unlink(picture);
  unlink(script);
}

static char history[] =
    "time_s,kinetic_J,elastic_J,step_s,force_a_b_x_N,force_a_b_y_N,force_a_b_z_N,force_a_c_x_N,"
    "force_a_c_y_N,force_a_c_z_N\n0,0,0,0,0,0,0,0,0,0\n1,2,0,0.5,3,4,0,0,0,0\n2,1,0,0.25,0,0,1,0,0,0\n";
static char name_a[] = "one", name_b[] = "two";

static Status write_history(const AppReportRun *runs, int count) {
  const char *labels[] = {name_a, name_b};
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, script));
  Status status = app_plot_history(writer.stream, picture, runs, count, labels);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

static char *read_script(void) {
  static char *text; // until the caller frees it
  size_t size;
  ck_assert_ok(file_read(script, &text, &size));
  return text;
}

static int count_of(const char *text, const char *part) {
  int count = 0;
  for (; (text = strstr(text, part)); text += strlen(part)) count++;
  return count;
}

START_TEST(a_history_has_a_curve_for_each_force_energy_and_step_that_is_not_zero) {
  AppReportRun runs[2] = {{.directory = name_a, .history = history},
                          {.directory = name_b, .history = history}};
  ck_assert_ok(write_history(runs, 2));
  char *text = read_script();
  ck_assert_int_eq(count_of(text, " title "), 6); // force a_b, kinetic, step; of two runs
  ck_assert_ptr_nonnull(strstr(text, "\"a_b, two\""));
  ck_assert_ptr_null(strstr(text, "\"a_c, one\""));
  ck_assert_ptr_null(strstr(text, "\"elastic, one\""));
  memory_free(text);
}
END_TEST

START_TEST(a_run_without_history_is_refused) {
  AppReportRun run = {.directory = name_a};
  ck_assert_int_eq(write_history(&run, 1), STATUS_INPUT);
  ck_assert(!file_exists(script));
}
END_TEST

START_TEST(another_ending_than_svg_pdf_and_png_is_refused) {
  AppReportRun run = {.directory = name_a, .history = history};
  snprintf(picture, sizeof picture, "/tmp/tetlap.jpg");
  ck_assert_int_eq(write_history(&run, 1), STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), ".pdf"));
}
END_TEST

// A dozen models close to each other, the last one exact.
static Record *make_pareto(void) {
  Record *pareto = record_new();
  RecordList *points = record_list(pareto, "points");
  for (int k = 0; k < MODELS; k++) {
    Record *point = record_append(points);
    char name[32];
    snprintf(name, sizeof name, "model-%d", k);
    record_text(point, "model", name);
    record_text(point, "family", k % 2 ? "odd" : "even");
    record_text(point, "quantity", "V");
    record_text(point, "set", "near");
    record_number(point, "seconds_per_pair", 1e-6 * (1 + 0.02 * k));
    record_number(point, "error", k == MODELS - 1 ? 0 : 1e-3 * (1 + 0.01 * k));
  }
  return pareto;
}

static Status write_frontier(const Record *pareto, const char *quantities) {
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, script));
  Status status = app_plot_frontier(writer.stream, picture, pareto, quantities);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

START_TEST(every_point_of_a_frontier_has_a_label_of_its_own_place) {
  Record *pareto = make_pareto();
  ck_assert_ok(write_frontier(pareto, NULL));
  char *text = read_script();
  double x[MODELS], y[MODELS];
  int count = 0;
  for (const char *at = text; (at = strstr(at, "set label \"")); at++) {
    ck_assert_int_lt(count, MODELS);
    ck_assert_int_eq(sscanf(strstr(at, "at screen "), "at screen %lf,%lf", &x[count], &y[count]), 2);
    ck_assert(x[count] > 0 && x[count] < 1 && y[count] > 0 && y[count] < 1);
    count++;
  }
  ck_assert_int_eq(count, MODELS);
  for (int i = 0; i < count; i++) // of a picture 520 × 380, letters 6 × 12
    for (int j = 0; j < i; j++)
      ck_assert_msg(fabs(x[i] - x[j]) * 520 > 7 * 6 - 0.1 || fabs(y[i] - y[j]) * 380 > 12 - 0.1,
                    "%d meets %d", i, j);
  ck_assert_ptr_nonnull(strstr(text, "\"model-11 (no error)\""));
  memory_free(text);
  record_destroy(pareto);
}
END_TEST

// Of one thread, unless a row lacks it or is a device's.
START_TEST(a_frontier_is_of_processor_time_where_there_is) {
  for (int k = 0; k < 3; k++) {
    Record *pareto = make_pareto();
    record_integer(pareto, "threads", k == 1 ? 2 : 1);
    RecordList *points = record_list(pareto, "points");
    for (int i = 0; i < 2; i++) {
      Record *point = record_append(points);
      record_text(point, "model", i ? "slow" : "quick");
      record_text(point, "family", "even");
      record_text(point, "quantity", "V+grad");
      record_text(point, "set", "near");
      record_number(point, "seconds_per_pair", i ? 8e-6 : 4e-6);
      record_number(point, "cpu_seconds_per_pair", i ? 3e-6 : 1e-6);
      record_number(point, "error", i ? 1e-4 : 1e-3);
      if (k == 2 && i) record_text(point, "device", "opencl");
    }
    ck_assert_ok(write_frontier(pareto, "V+grad"));
    char *text = read_script();
    double x = 0;
    ck_assert_int_eq(sscanf(strstr(text, "$f0 << END\n") + strlen("$f0 << END\n"), "%lf", &x), 1);
    ck_assert_near(x, k == 0 ? 1e-6 : 4e-6, 1e-12);
    ck_assert_int_eq(strstr(text, "set xlabel 'processor time a pair'") != NULL, k == 0);
    memory_free(text);
    record_destroy(pareto);
  }
}
END_TEST

START_TEST(points_on_the_frontier_are_filled) {
  Record *pareto = make_pareto();
  ck_assert_ok(write_frontier(pareto, "V"));
  char *text = read_script(), *front = strstr(text, "$f0 << END\n");
  ck_assert_ptr_nonnull(front);
  double x[2], y[2];
  // The fastest, which is more accurate than all but the last, and the exact one.
  ck_assert_int_eq(sscanf(front, "$f0 << END\n%lf %lf\n%lf %lf\nEND", &x[0], &y[0], &x[1], &y[1]), 4);
  ck_assert_near(x[0], 1e-6, 1e-13);
  ck_assert_near(x[1], 1.22e-6, 1e-13);
  ck_assert(y[1] < y[0]);
  memory_free(text);
  record_destroy(pareto);
}
END_TEST

START_TEST(a_file_without_such_points_is_refused) {
  Record *pareto = make_pareto(), *other = record_new();
  ck_assert_int_eq(write_frontier(pareto, "force"), STATUS_INPUT);
  ck_assert_int_eq(write_frontier(other, NULL), STATUS_INPUT);
  record_destroy(pareto);
  record_destroy(other);
}
END_TEST

// Its line and column are named.
START_TEST(a_damaged_history_is_refused) {
  static const struct {
    char text[64];
    const char *word;
  } cases[] = {{"time_s,step_s\n0,0\n1,abc\n", "history.csv:3: step_s is 'abc'"},
               {"time_s,step_s\n0,0\n1\n", "history.csv:3: fewer columns"},
               {"time_s,step_s\n0,0,0\n", "history.csv:2: more columns"},
               {"time_s,step_s\n0,0\n1,0.2", "history.csv:3: the line does not end"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[64];
    memcpy(text, cases[k].text, sizeof text);
    AppReportRun run = {.directory = name_a, .history = text};
    ck_assert_int_eq(write_history(&run, 1), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), cases[k].word) != NULL, "%s", status_message());
  }
}
END_TEST

// A picture that was there stays as it was, and nothing is left beside it.
START_TEST(a_picture_that_gnuplot_does_not_end_is_none) {
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, picture));
  fputs("of before", writer.stream);
  ck_assert_ok(file_commit(&writer));
  static const char *const scripts[] = {"exit status 3", "set print picture\nprint '<svg>'"};
  for (int k = 0; k < 2; k++) {
    ck_assert_ok(file_begin(&writer, script));
    app_gnuplot_output(writer.stream, picture);
    fprintf(writer.stream, "%s\n", scripts[k]);
    ck_assert_ok(file_commit(&writer));
    ck_assert_int_eq(app_gnuplot_run(script, picture), STATUS_IO);
    ck_assert_ptr_nonnull(strstr(status_message(), k ? "did not draw all" : "failed"));
    char *text;
    size_t size;
    ck_assert_ok(file_read(picture, &text, &size));
    ck_assert_str_eq(text, "of before");
    memory_free(text);
  }
}
END_TEST

START_TEST(gnuplot_draws_both) {
  AppReportRun run = {.directory = name_a, .history = history};
  struct stat info;
  ck_assert_ok(write_history(&run, 1));
  ck_assert_ok(app_gnuplot_run(script, picture));
  ck_assert_int_eq(stat(picture, &info), 0);
  ck_assert_int_gt((int)info.st_size, 4000);
  Record *pareto = make_pareto();
  ck_assert_ok(write_frontier(pareto, NULL));
  ck_assert_ok(app_gnuplot_run(script, picture));
  char *text;
  size_t size;
  ck_assert_ok(file_read(picture, &text, &size));
  ck_assert_int_ge(count_of(text, "model-"), MODELS);
  memory_free(text);
  record_destroy(pareto);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("plot");
  tcase_add_checked_fixture(test_case, name_files, remove_files);
  tcase_add_test(test_case, a_history_has_a_curve_for_each_force_energy_and_step_that_is_not_zero);
  tcase_add_test(test_case, a_run_without_history_is_refused);
  tcase_add_test(test_case, another_ending_than_svg_pdf_and_png_is_refused);
  tcase_add_test(test_case, every_point_of_a_frontier_has_a_label_of_its_own_place);
  tcase_add_test(test_case, a_frontier_is_of_processor_time_where_there_is);
  tcase_add_test(test_case, points_on_the_frontier_are_filled);
  tcase_add_test(test_case, a_file_without_such_points_is_refused);
  tcase_add_test(test_case, a_damaged_history_is_refused);
  tcase_add_test(test_case, a_picture_that_gnuplot_does_not_end_is_none);
  tcase_add_test(test_case, gnuplot_draws_both);
  return suite_run("plot", test_case, 20);
}
