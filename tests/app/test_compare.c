// SPDX-License-Identifier: GPL-3.0-or-later
// What a comparison says of runs that did not get to their end.
#include "suite.h"

#include <math.h>
#include <string.h>

#include "app/compare/comparison.h"
#include "base/memory.h"

enum { FRAMES = 4 };

// A run of one vertex and one interface; `forces` along z and positions along x of each frame that was
// reached.
typedef struct Kept {
  double forces[3 * FRAMES], trajectory[3 * FRAMES];
  FemRunResult result;
} Kept;

static void keep(Kept *kept, int frame_count, const double *forces, const double *positions) {
  *kept = (Kept){0};
  for (int f = 0; f < frame_count; f++)
    kept->forces[3 * f + 2] = forces[f], kept->trajectory[3 * f] = positions[f];
  kept->result = (FemRunResult){.frame_count = frame_count,
                                .vertex_count = 1,
                                .interface_count = 1,
                                .interface_forces = kept->forces,
                                .trajectory = kept->trajectory};
}

static const double FORCES[FRAMES] = {0, 0, 3, 4}, POSITIONS[FRAMES] = {0, 1, 2, 3};

START_TEST(errors_are_over_the_frames_that_both_have_reached) {
  Kept reference, other;
  keep(&reference, 4, FORCES, POSITIONS);
  keep(&other, 3, (const double[]){0, 0, 6}, (const double[]){0, 1, 5});
  ck_assert_int_eq(app_comparison_common_frames(&other.result, &reference.result), 3);
  AppForceError error = app_comparison_force_error(&other.result, &reference.result);
  ck_assert_near(error.l2, 1, 1e-15);
  ck_assert_near(error.max, 1, 1e-15);
  ck_assert_near(app_comparison_trajectory_error(&other.result, &reference.result), sqrt(3), 1e-15);
}
END_TEST

START_TEST(a_run_that_fails_before_it_touches_has_no_force_error) {
  Kept reference, failed, at_once;
  keep(&reference, 4, FORCES, POSITIONS);
  keep(&failed, 2, FORCES, POSITIONS);
  keep(&at_once, 0, NULL, NULL);
  ck_assert(isnan(app_comparison_force_error(&failed.result, &reference.result).l2));
  ck_assert(isnan(app_comparison_force_error(&failed.result, &reference.result).max));
  ck_assert(isnan(app_comparison_interface_error(&failed.result, &reference.result, 0).l2));
  ck_assert(isnan(app_comparison_trajectory_error(&at_once.result, &reference.result)));
}
END_TEST

// What a command prints, both streams.
static int print(const char *words, char *text, size_t size) {
  char command[1024];
  snprintf(command, sizeof command, "%s %s 2>&1", TETLAP_PROGRAM, words);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t count = fread(text, 1, size - 1, pipe);
  text[count] = 0;
  return pclose(pipe) >> 8;
}

// The run that --wall cuts has a row that says so. No machine is so fast that it would come to the end:
// eleven days of the scene's time.
START_TEST(a_run_that_takes_too_long_is_cut_and_looks_it) {
  static char text[1 << 16];
  char folder[] = "/tmp/tetlap_compare_XXXXXX", words[512];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "compare " TETLAP_SOURCE_DIR "/examples/02_two_blocks.yaml --overlap clip --wall 0.2 -t 1 "
           "-o %s --set output.vtu=false --set time.end=1e6 --set time.max_step=1e-3 --set output.frames=10",
           folder);
  int exit_code = print(words, text, sizeof text);
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
  ck_assert_int_eq(exit_code, 70);
  ck_assert_msg(strstr(text, "cut short") != NULL, "%s", text);
  ck_assert_msg(strstr(text, "--wall") != NULL, "%s", text);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("compare");
  tcase_add_test(cases, errors_are_over_the_frames_that_both_have_reached);
  tcase_add_test(cases, a_run_that_fails_before_it_touches_has_no_force_error);
  tcase_add_test(cases, a_run_that_takes_too_long_is_cut_and_looks_it);
  return suite_run("compare", cases, 120);
}
