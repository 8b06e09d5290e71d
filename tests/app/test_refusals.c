// SPDX-License-Identifier: GPL-3.0-or-later
// What the program refuses, with its exit code and what it says, and that it leaves files as they were.
#include "suite.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/tetlap_refusals_XXXXXX", message[8192];

static void enter_folder(void) {
  ck_assert_ptr_nonnull(mkdtemp(folder));
  ck_assert_int_eq(chdir(folder), 0);
  setenv("tetlap", TETLAP_PROGRAM, 1);
  setenv("examples", TETLAP_SOURCE_DIR "/examples", 1);
}

static void leave_folder(void) {
  char command[64];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
  memset(folder + strlen(folder) - 6, 'X', 6);
}

// The exit code of a line of the shell in the folder; what it printed is in `message`. $tetlap is the
// program, $examples the examples' folder.
static int code_of(const char *line) {
  char command[1024];
  snprintf(command, sizeof command, "(%s) > message 2>&1", line);
  int state = system(command);
  FILE *stream = fopen("message", "r");
  message[fread(message, 1, sizeof message - 1, stream)] = 0;
  fclose(stream);
  return WEXITSTATUS(state);
}

static bool says(const char *words) {
  return strstr(message, words) != NULL;
}

#define ck_assert_refused(code, line, words)                                                                 \
  do {                                                                                                       \
    int ck_code_ = code_of(line);                                                                            \
    ck_assert_msg(ck_code_ == (code) && says(words), "%s: %d: %s", line, ck_code_, message);                 \
  } while (0)

START_TEST(a_data_set_that_finds_no_room_is_one_message_with_the_system_s_reason) {
  static const char *const counts[] = {"100", "2000", "20000"};
  for (int i = 0; i < 3; i++) {
    char line[200];
    snprintf(line, sizeof line, "ulimit -f 8; $tetlap datagen --law scene -q -n %s -o a.h5", counts[i]);
    ck_assert_refused(74, line, ": File too large");
    ck_assert_msg(strchr(message, '\n') == message + strlen(message) - 1, "%s", message);
    ck_assert_int_ne(access("a.h5", F_OK), 0);
  }
}
END_TEST

START_TEST(a_name_that_is_none_is_a_usage_error) {
  ck_assert_refused(64, "$tetlap eval nope --law scene -n 10", "there is no overlap model 'nope'");
  ck_assert_refused(64, "$tetlap weights clip", "has no weights of its own");
  ck_assert_refused(64, "$tetlap weights nope", "there are no weights 'nope'");
  ck_assert_refused(74, "$tetlap weights ./nope.safetensors", "cannot be opened");
  ck_assert_refused(0, "$tetlap weights tpn-bf16", "tpn.safetensors");
}
END_TEST

START_TEST(an_option_without_effect_is_a_usage_error) {
  ck_assert_refused(64, "$tetlap eval clip a.h5 --mix none=1", "--mix changes a law");
  ck_assert_refused(64, "$tetlap eval clip a.h5 --volume natural", "--volume changes a law");
  ck_assert_refused(64, "$tetlap eval clip a.h5 --seed 1", "--seed is of the pairs of a --law");
  ck_assert_refused(64, "$tetlap eval clip --paths 2 --count 1", "--count is of the pairs");
  ck_assert_refused(64, "$tetlap poses $examples/02_two_blocks.yaml --poses p.txt --seed 2",
                    "--seed is of random");
  ck_assert_refused(64, "$tetlap poses $examples/02_two_blocks.yaml --poses p.txt --turn 1",
                    "--turn is of random");
  ck_assert_refused(64, "$tetlap train $examples/train/smoke.yaml --resume -o empty",
                    "there is nothing to resume");
}
END_TEST

// A short run of a scene in the folder, whose block touches nothing.
static void run_drop(void) {
  ck_assert_refused(0,
                    "cp $examples/01_drop.yaml scene.yaml && "
                    "$tetlap run scene.yaml -q -o run -s time.end=0.01 -s output.frames=1",
                    "");
}

START_TEST(what_a_run_reads_or_wrote_is_not_written_over) {
  run_drop();
  ck_assert_refused(64, "$tetlap run scene.yaml -q -o run --capture ./scene.yaml", "is the scene itself");
  static const char *const files[] = {"run/history.csv", "run/summary.json", "run/frames.pvd", "scene.yaml"};
  for (int i = 0; i < 4; i++) {
    char line[200];
    snprintf(line, sizeof line, "cp %s kept; ln -sf %s link; $tetlap report run -o link", files[i], files[i]);
    ck_assert_refused(64, line, "would replace a file that it is made from");
    snprintf(line, sizeof line, "cmp kept %s", files[i]);
    ck_assert_refused(0, line, "");
  }
  ck_assert_refused(0, "$tetlap report run -q -o run/r.html && $tetlap report run -q -o run/r.html", "");
}
END_TEST

START_TEST(a_capture_of_no_pairs_is_told) {
  run_drop();
  ck_assert_refused(0, "$tetlap run scene.yaml -o run -s time.end=0.01 --capture a.h5",
                    "no two elements came so near");
  ck_assert_int_ne(access("a.h5", F_OK), 0);
}
END_TEST

START_TEST(stress_names_the_model_that_is_none) {
  ck_assert_refused(64, "$tetlap stress -m clpi --pairs", "did you mean 'clip'");
  ck_assert_refused(64, "$tetlap stress -m clip,my.safetensors", "add --pairs");
  ck_assert_refused(74, "$tetlap stress -m my.safetensors --pairs", "my.safetensors: cannot be opened");
}
END_TEST

// Weights that are no safetensors file, by every way to name them.
START_TEST(a_file_of_pytorch_is_refused_with_what_to_do) {
  ck_assert_refused(0, "printf 'PK\\003\\004 as torch.save writes it' > net.pt", "");
  ck_assert_refused(65, "$tetlap eval ./net.pt --law scene -n 10", "as in mine.py:Net");
  ck_assert_refused(65, "$tetlap run $examples/02_two_blocks.yaml -m ./net.pt -o out", "file of PyTorch");
  ck_assert_int_ne(access("out", F_OK), 0);
}
END_TEST

// A model that gives V alone is refused before anything runs, not where contact begins.
START_TEST(an_audit_of_forces_needs_more_than_volumes) {
  ck_assert_refused(
      65,
      "$tetlap compare $examples/02_two_blocks.yaml --overlap clip --audit-only " TETLAP_MODEL_16 " -o out",
      "error: --audit-only: ");
  ck_assert(says("gives V alone: forces need its centroid or its gradient"));
  ck_assert_int_ne(access("out", F_OK), 0);
}
END_TEST

// Mean errors of data with other volumes than the paper's are no better or worse than its own.
START_TEST(the_papers_figures_stand_beside_data_like_the_papers_alone) {
  ck_assert_refused(0, "$tetlap eval clip --law paper-test -n 20 | grep -q 'mean |dV| *paper'", "");
  ck_assert_refused(0, "! $tetlap eval clip --law scene -n 20 | grep -q paper", "");
  ck_assert_refused(
      0,
      "$tetlap datagen -q --law paper-test -n 20 -o law.h5 && $tetlap eval clip law.h5 | grep -q paper:", "");
  ck_assert_refused(
      0, "$tetlap datagen -q --law scene -n 20 -o law.h5 && ! $tetlap eval clip law.h5 | grep -q paper:", "");
}
END_TEST

// 2^53 + 1: read back from verdict.json as a double it would be 2^53.
START_TEST(a_seed_that_verdict_json_would_round_is_refused) {
  ck_assert_refused(64, "$tetlap verdict clip --quick --seed 9007199254740993 -o out",
                    "keeps seeds up to 9007199254740992 exactly");
  ck_assert_int_ne(access("out", F_OK), 0);
}
END_TEST

START_TEST(models_in_one_word_are_refused) {
  ck_assert_refused(64, "$tetlap verdict clip,geo --quick -o out",
                    "name several models as words of their own");
  ck_assert_int_ne(access("out", F_OK), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("refusals");
  tcase_add_checked_fixture(cases, enter_folder, leave_folder);
  tcase_add_test(cases, a_data_set_that_finds_no_room_is_one_message_with_the_system_s_reason);
  tcase_add_test(cases, a_name_that_is_none_is_a_usage_error);
  tcase_add_test(cases, an_option_without_effect_is_a_usage_error);
  tcase_add_test(cases, what_a_run_reads_or_wrote_is_not_written_over);
  tcase_add_test(cases, a_capture_of_no_pairs_is_told);
  tcase_add_test(cases, stress_names_the_model_that_is_none);
  tcase_add_test(cases, a_file_of_pytorch_is_refused_with_what_to_do);
  tcase_add_test(cases, an_audit_of_forces_needs_more_than_volumes);
  tcase_add_test(cases, the_papers_figures_stand_beside_data_like_the_papers_alone);
  tcase_add_test(cases, a_seed_that_verdict_json_would_round_is_refused);
  tcase_add_test(cases, models_in_one_word_are_refused);
  return suite_run("refusals", cases, 120);
}
