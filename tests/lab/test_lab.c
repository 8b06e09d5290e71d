// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab`: the peak of a core, and the rows that scripts read.
#include "bench_rows.h"
#include "lab/peak.h"

static const char LAB[] = TETLAP_LAB;

START_TEST(the_peak_is_a_number) {
  double single = lab_peak_measure(true), twice = lab_peak_measure(false);
  ck_assert_double_gt(twice, 0);
  ck_assert_double_gt(single, 0);
  ck_assert(isfinite(single) && isfinite(twice));
}
END_TEST

static const Promise promises[] = {
    {"net --net geo,geo-small --batch 100 --repeat 1 --no-torch --threads 2 --quantity V", 0,
     "bench net implementation precision quantity spread ratio_to_torch difference",
     "parameters batch threads samples_per_second samples_per_cpu_second flops gflops peak_share"},
    {"device host --model clip,tpn --set near --quantity V --residence device --batch 100 --repeat 1", 2,
     "bench model set quantity residence gate of_peak of_issue spread device",
     "batch kernel_pairs_s pairs_s"},
};
enum { PROMISE_COUNT = sizeof promises / sizeof *promises };

START_TEST(rows_carry_the_promised_keys) {
  check_promise(LAB, &promises[_i]);
}
END_TEST

static int count(const char *text, char letter) {
  int found = 0;
  for (; *text; text++) found += *text == letter;
  return found;
}

START_TEST(csv_and_markdown_have_as_many_cells_in_every_line) {
  static char output[OUTPUT_SIZE];
  const char words[] = "net --net geo-small --quantity V --batch 10 --repeat 1 --no-torch";
  char command[128];
  snprintf(command, sizeof command, "%s --csv", words);
  ck_assert_int_eq(run_bench(LAB, command, output), 0);
  char *head = strtok(output, "\n"), *row = strtok(NULL, "\n");
  ck_assert_int_eq(strncmp(head, "bench,net,", 10), 0);
  ck_assert_int_eq(strncmp(row, "net,geo-small,", 14), 0);
  ck_assert_int_eq(count(row, ','), count(head, ','));
  snprintf(command, sizeof command, "%s --markdown", words);
  ck_assert_int_eq(run_bench(LAB, command, output), 0);
  int lines = 0, cells = 0;
  for (const char *line = strtok(output, "\n"); line; line = strtok(NULL, "\n"), lines++) {
    if (lines == 0) cells = count(line, '|');
    ck_assert_int_eq(count(line, '|'), cells);
  }
  ck_assert_int_ge(lines, 3); // heads, rule, a row a kernel
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  static char output[OUTPUT_SIZE];
  static const char *const wrong[] = {
      "device",           "device host --model clap",     "device host --model net/weights/geo.safetensors",
      "device host cuda", "device host --residence here", "net --net ,",
      "net --threads 0"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(run_bench(LAB, wrong[k], output) == 64, "%s", wrong[k]);
}
END_TEST

START_TEST(an_unknown_command_gets_the_nearest_name) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(LAB, "devcie 2>&1", output), 64);
  ck_assert_msg(strstr(output, "tetlap-lab device") != NULL, "%s", output);
  ck_assert_int_eq(run_bench(LAB, "--help", output), 0);
  ck_assert_ptr_nonnull(strstr(output, "device"));
  ck_assert_ptr_null(strstr(output, "`tetlap ")); // another program's command
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("lab");
  tcase_add_test(cases, the_peak_is_a_number);
  tcase_add_loop_test(cases, rows_carry_the_promised_keys, 0, PROMISE_COUNT);
  tcase_add_test(cases, csv_and_markdown_have_as_many_cells_in_every_line);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  tcase_add_test(cases, an_unknown_command_gets_the_nearest_name);
  return suite_run("lab", cases, 60);
}
