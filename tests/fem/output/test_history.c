// SPDX-License-Identifier: GPL-3.0-or-later
// fem/output/history.h: what goes in comes out, every line at once and whole, and can be gone on with.
#include "suite.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/output/history.h"

static char path[64];

static void name_path(void) {
  snprintf(path, sizeof path, "/tmp/tetlap_history_%ld.csv", (long)getpid());
}

static void remove_path(void) {
  unlink(path);
}

// The whole file; owned by the caller.
static void read_path(char **text) {
  size_t size;
  ck_assert_ok(file_read(path, text, &size));
}

static void create_two_columns(FemHistory *history) {
  ck_assert_ok(fem_history_create(history, path));
  ck_assert_ok(fem_history_add_column(history, "time_s"));
  ck_assert_ok(fem_history_add_column(history, "force_%s_%s_x_N", "top", "bottom"));
}

START_TEST(the_first_line_names_the_columns) {
  FemHistory history;
  create_two_columns(&history);
  ck_assert_ok(fem_history_add_row(&history, (double[]){0, 2.5}));
  char *text;
  read_path(&text);
  ck_assert_str_eq(text, "time_s,force_top_bottom_x_N\n0,2.5\n");
  memory_free(text);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(numbers_read_back_to_the_same_double) {
  enum { ROWS = 1000 };
  Random random = random_seeded(3, 0);
  double rows[ROWS][2];
  FemHistory history;
  create_two_columns(&history);
  for (int r = 0; r < ROWS; r++) {
    rows[r][0] = r * 0.1;
    rows[r][1] = ldexp(suite_normal(&random), random_below(&random, 2000) - 1000);
    ck_assert_ok(fem_history_add_row(&history, rows[r]));
  }
  char *text, *place;
  read_path(&text);
  place = strchr(text, '\n') + 1;
  for (int r = 0; r < ROWS; r++)
    for (int c = 0; c < 2; c++, place++) {
      ck_assert(strtod(place, &place) == rows[r][c]);
      ck_assert_int_eq(*place, c ? '\n' : ',');
    }
  ck_assert_int_eq(*place, 0);
  memory_free(text);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(numbers_that_are_not_finite_have_a_spelling) {
  FemHistory history;
  create_two_columns(&history);
  ck_assert_ok(fem_history_add_column(&history, "third"));
  ck_assert_ok(fem_history_add_row(&history, (double[]){-NAN, INFINITY, -INFINITY}));
  char *text;
  read_path(&text);
  ck_assert_str_eq(strchr(text, '\n') + 1, "nan,inf,-inf\n");
  memory_free(text);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(a_title_with_a_comma_is_quoted) {
  FemHistory history;
  ck_assert_ok(fem_history_create(&history, path));
  ck_assert_ok(fem_history_add_column(&history, "a"));
  ck_assert_ok(fem_history_add_column(&history, "the \"big\", red one"));
  ck_assert_ok(fem_history_add_row(&history, (double[]){1, 2}));
  char *text;
  read_path(&text);
  ck_assert_str_eq(text, "a,\"the \"\"big\"\", red one\"\n1,2\n");
  memory_free(text);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(two_columns_of_one_name_are_refused) {
  FemHistory history;
  ck_assert_ok(fem_history_create(&history, path));
  ck_assert_ok(fem_history_add_column(&history, "force_%s_%s_x_N", "a_b", "c"));
  ck_assert_int_eq(fem_history_add_column(&history, "force_%s_%s_x_N", "a", "b_c"), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "force_a_b_c_x_N"));
  ck_assert_int_eq(history.column_count, 1);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(of_many_columns_the_last_finds_the_first) {
  enum { MANY = 3000 };
  FemHistory history;
  ck_assert_ok(fem_history_create(&history, path));
  for (int c = 0; c < MANY; c++) ck_assert_ok(fem_history_add_column(&history, "force_%d_x_N", c));
  for (int c = 0; c < MANY; c += 7)
    ck_assert_int_eq(fem_history_add_column(&history, "force_%d_x_N", c), STATUS_INPUT);
  ck_assert_int_eq(history.column_count, MANY);
  fem_history_destroy(&history);
}
END_TEST

START_TEST(rows_reach_the_file_at_once) {
  FemHistory history;
  create_two_columns(&history);
  for (int r = 0; r < 3; r++) {
    ck_assert_ok(fem_history_add_row(&history, (double[]){r, r}));
    char *text;
    read_path(&text);
    int lines = 0;
    for (const char *c = text; *c; c++) lines += *c == '\n';
    ck_assert_int_eq(lines, r + 2);
    memory_free(text);
  }
  fem_history_destroy(&history);
}
END_TEST

// After each of the rows in its turn a second history goes on where the first one was marked, beyond which it
// had come by two rows more.
START_TEST(what_goes_on_is_what_was_not_interrupted) {
  enum { ROWS = 6 };
  char *whole = NULL;
  for (int marked = 0; marked <= ROWS; marked++) {
    FemHistory first, second;
    JournalMark mark = {0};
    remove_path();
    create_two_columns(&first), create_two_columns(&second);
    for (int r = 0; r < marked + 2 && r < ROWS; r++) {
      if (r == marked) mark = first.file.end;
      ck_assert_ok(fem_history_add_row(&first, (double[]){r, 1.0 / (r + 3)}));
    }
    if (marked == ROWS) mark = first.file.end;
    ck_assert_ok(fem_history_continue(&second, mark));
    for (int r = marked; r < ROWS; r++)
      ck_assert_ok(fem_history_add_row(&second, (double[]){r, 1.0 / (r + 3)}));
    char *text;
    read_path(&text);
    if (whole) ck_assert_str_eq(text, whole);
    if (whole) memory_free(text);
    if (!whole) whole = text;
    fem_history_destroy(&first), fem_history_destroy(&second);
  }
  ck_assert_ptr_nonnull(strstr(whole, "\n5,0.125\n"));
  memory_free(whole);
}
END_TEST

// The k-th allocation of all fails, for every k: a row is there whole or not at all, and can be added again.
START_TEST(a_failed_allocation_adds_no_half_row) {
  enum { ROWS = 3 };
  int failures = 0;
  for (long k = 1;; k++) {
    FemHistory history;
    bool has_failed = false;
    remove_path();
    create_two_columns(&history);
    memory_fail_at(k);
    for (int r = 0; r < ROWS; r++) {
      Status status = fem_history_add_row(&history, (double[]){r, r});
      ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
      if (status) has_failed = true, r--;
    }
    memory_fail_at(0);
    char *text;
    read_path(&text);
    ck_assert_str_eq(text, "time_s,force_top_bottom_x_N\n0,0\n1,1\n2,2\n");
    memory_free(text);
    fem_history_destroy(&history);
    if (!has_failed) break;
    failures++;
  }
  ck_assert_int_gt(failures, 2);
}
END_TEST

// Writes rows until it is killed.
static void write_for_ever(int ready) {
  FemHistory history;
  create_two_columns(&history);
  for (int r = 0;; r++) {
    if (fem_history_add_row(&history, (double[]){r, 2 * r})) _exit(1);
    if (r == 20 && write(ready, "r", 1) != 1) _exit(1);
  }
}

START_TEST(a_killed_writer_leaves_whole_lines_but_for_the_last) {
  int pipe_ends[2];
  ck_assert_int_eq(pipe(pipe_ends), 0);
  pid_t child = fork();
  if (child == 0) write_for_ever(pipe_ends[1]);
  char signal_byte;
  ck_assert_int_eq(read(pipe_ends[0], &signal_byte, 1), 1);
  kill(child, SIGKILL);
  int exit_status;
  waitpid(child, &exit_status, 0);
  ck_assert(WIFSIGNALED(exit_status));
  char *text, *place;
  read_path(&text);
  place = strchr(text, '\n') + 1;
  int rows = 0;
  for (; strchr(place, '\n'); rows++, place++) {
    ck_assert(strtod(place, &place) == rows);
    ck_assert_int_eq(*place++, ',');
    ck_assert(strtod(place, &place) == 2 * rows);
    ck_assert_int_eq(*place, '\n');
  }
  ck_assert_int_ge(rows, 21);
  memory_free(text);
}
END_TEST

START_TEST(a_place_that_cannot_be_written_is_named) {
  FemHistory history;
  ck_assert_ok(fem_history_create(&history, "/tmp/no_such_directory/history.csv"));
  ck_assert_ok(fem_history_add_column(&history, "time_s"));
  ck_assert_int_eq(fem_history_add_row(&history, (double[]){0}), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "/tmp/no_such_directory/history.csv"));
  fem_history_destroy(&history);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("history");
  tcase_add_checked_fixture(cases, name_path, remove_path);
  tcase_add_test(cases, the_first_line_names_the_columns);
  tcase_add_test(cases, numbers_read_back_to_the_same_double);
  tcase_add_test(cases, numbers_that_are_not_finite_have_a_spelling);
  tcase_add_test(cases, a_title_with_a_comma_is_quoted);
  tcase_add_test(cases, two_columns_of_one_name_are_refused);
  tcase_add_test(cases, of_many_columns_the_last_finds_the_first);
  tcase_add_test(cases, rows_reach_the_file_at_once);
  tcase_add_test(cases, what_goes_on_is_what_was_not_interrupted);
  tcase_add_test(cases, a_failed_allocation_adds_no_half_row);
  tcase_add_test(cases, a_killed_writer_leaves_whole_lines_but_for_the_last);
  tcase_add_test(cases, a_place_that_cannot_be_written_is_named);
  return suite_run("history", cases, 30);
}
