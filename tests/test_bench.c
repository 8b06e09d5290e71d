// SPDX-License-Identifier: GPL-3.0-or-later
// The sets of pairs that benchmarks use, and the rows that scripts read.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#include "app/bench_pairs.h"

enum { COUNT = 50 };

START_TEST(the_same_seed_gives_the_same_pairs) {
  static double first[COUNT * 24], again[COUNT * 24], other[COUNT * 24];
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 3, first));
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 3, again));
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 4, other));
  ck_assert_mem_eq(first, again, sizeof first);
  ck_assert_mem_ne(first, other, sizeof first);
}
END_TEST

START_TEST(an_unknown_set_is_an_error_that_names_the_known_ones) {
  double pair[24];
  ck_assert_int_eq(app_bench_pairs_make("nearly", 1, 1, pair), STATUS_USAGE);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++)
    ck_assert_ptr_nonnull(strstr(status_message(), app_bench_sets[set]));
}
END_TEST

// What `tetlap bench` with these arguments prints; its exit code.
static int run_bench(const char *arguments, char *output, size_t size) {
  char command[512];
  snprintf(command, sizeof command, "'%s' bench %s 2>/dev/null", TETLAP_PROGRAM, arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, size - 1, pipe)] = 0;
  int ended = pclose(pipe);
  return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
}

START_TEST(json_rows_carry_the_promised_keys) {
  static char output[1 << 16];
  ck_assert_int_eq(run_bench("overlap --model clip,exact --set near,uniform --quantity V+grad --batch 100 "
                             "--repeat 1 --threads 2 --json",
                             output, sizeof output),
                   0);
  const char *keys[] = {
      "bench", "model", "set", "quantity", "threads", "batch", "pairs_per_second", "pairs_per_cpu_second"};
  int rows = 0;
  for (char *line = strtok(output, "\n"); line; line = strtok(NULL, "\n"), rows++) {
    ck_assert_int_eq(line[0], '{');
    ck_assert_int_eq(line[strlen(line) - 1], '}');
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
      char quoted[64];
      snprintf(quoted, sizeof quoted, "\"%s\":", keys[k]);
      ck_assert_msg(strstr(line, quoted), "no %s in %s", quoted, line);
    }
    ck_assert_ptr_nonnull(strstr(line, "\"threads\":2,\"batch\":100,"));
  }
  ck_assert_int_eq(rows, 4);
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  char output[256];
  const char *wrong[] = {"",
                         "everything",
                         "overlap --model clap",
                         "overlap --set far",
                         "overlap --quantity W",
                         "overlap --batch 0",
                         "overlap --repeat many",
                         "overlap --model exact --quantity V+grad+hess"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(run_bench(wrong[k], output, sizeof output) == 64, "%s", wrong[k]);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("bench");
  tcase_add_loop_test(cases, the_same_seed_gives_the_same_pairs, 0, APP_BENCH_SET_COUNT);
  tcase_add_test(cases, an_unknown_set_is_an_error_that_names_the_known_ones);
  tcase_add_test(cases, json_rows_carry_the_promised_keys);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  return suite_run("bench", cases, 30);
}
