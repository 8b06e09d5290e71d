// SPDX-License-Identifier: GPL-3.0-or-later
// app/plot: the scripts hold every curve, and gnuplot draws them.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/plot/gnuplot.h"
#include "app/plot/plot.h"
#include "base/files/file.h"
#include "base/memory.h"

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

// A static run has no steps, a body that flies no forces, one that rests no energy.
START_TEST(gnuplot_draws_a_history_of_which_parts_are_nothing) {
  static char texts[][160] = {
      "time_s,elastic_J,step_s,force_a_b_x_N,force_a_b_y_N,force_a_b_z_N\n0,0,0,0,0,0\n1,2,0,1,0,0\n",
      "time_s,kinetic_J,step_s\n0,1,0\n1,2,0.1\n", "time_s,kinetic_J,step_s\n0,0,0\n1,0,0\n"};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    AppReportRun run = {.directory = name_a, .history = texts[k]};
    ck_assert_ok(write_history(&run, 1));
    ck_assert_ok(app_gnuplot_run(script, picture));
    char *text = read_script();
    ck_assert_int_eq(count_of(text, "\"step\""), k == 1);
    memory_free(text);
  }
}
END_TEST

START_TEST(gnuplot_draws_a_history) {
  AppReportRun run = {.directory = name_a, .history = history};
  struct stat info;
  ck_assert_ok(write_history(&run, 1));
  ck_assert_ok(app_gnuplot_run(script, picture));
  ck_assert_int_eq(stat(picture, &info), 0);
  ck_assert_int_gt((int)info.st_size, 4000);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("plot");
  tcase_add_checked_fixture(test_case, name_files, remove_files);
  tcase_add_test(test_case, a_history_has_a_curve_for_each_force_energy_and_step_that_is_not_zero);
  tcase_add_test(test_case, a_run_without_history_is_refused);
  tcase_add_test(test_case, another_ending_than_svg_pdf_and_png_is_refused);
  tcase_add_test(test_case, a_damaged_history_is_refused);
  tcase_add_test(test_case, a_picture_that_gnuplot_does_not_end_is_none);
  tcase_add_test(test_case, gnuplot_draws_a_history);
  tcase_add_test(test_case, gnuplot_draws_a_history_of_which_parts_are_nothing);
  return suite_run("plot", test_case, 20);
}
