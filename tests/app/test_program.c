// SPDX-License-Identifier: GPL-3.0-or-later
// app/program.h, app/cli/argument.h: exit codes.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/program.h"

static const char *const full_yaml = TETLAP_SOURCE_DIR "/tests/data/scene/full.yaml";

static int run_program(const char *first, const char *second, const char *third) {
  const char *texts[] = {"tetlap", first, second, third};
  char *arguments[5] = {NULL};
  int count = 0;
  for (; count < 4 && texts[count]; count++) arguments[count] = strdup(texts[count]);
  ck_assert_ptr_nonnull(freopen("/dev/null", "w", stdout));
  ck_assert_ptr_nonnull(freopen("/dev/null", "w", stderr));
  char *kept[4];
  memcpy(kept, arguments, sizeof kept);
  int code = app_program_run(&app_program_root, count, arguments);
  for (int i = 0; i < count; i++) free(kept[i]);
  return code;
}

START_TEST(exit_codes_say_who_is_to_blame) {
  ck_assert_int_eq(run_program(NULL, NULL, NULL), 64);
  ck_assert_int_eq(run_program("rnu", NULL, NULL), 64);
  ck_assert_int_eq(run_program("help", NULL, NULL), 0);
  ck_assert_int_eq(run_program("version", NULL, NULL), 0);
  ck_assert_int_eq(run_program("effects", NULL, NULL), 0);
  ck_assert_int_eq(run_program("schema", NULL, NULL), 0);
  ck_assert_int_eq(run_program("schema", "--markdown", NULL), 0);
  ck_assert_int_eq(run_program("check", "/nowhere.yaml", NULL), 74);
  ck_assert_int_eq(run_program("check", full_yaml, NULL), 74); // its meshes are not there
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/CMakeLists.txt", NULL), 65);
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/examples/01_drop.yaml", "--set=time.ende=3"), 64);
  ck_assert_int_eq(run_program("check", TETLAP_SOURCE_DIR "/examples/01_drop.yaml", "--json"), 0);
}
END_TEST

static int exit_code_of(const char *arguments) {
  char command[512];
  snprintf(command, sizeof command, "%s %s > /dev/null 2>&1", TETLAP_PROGRAM, arguments);
  return WEXITSTATUS(system(command));
}

START_TEST(an_option_that_is_no_number_in_its_range_is_a_usage_error) {
  ck_assert_int_eq(exit_code_of("run scene.yaml --threads 2x"), 64);
  ck_assert_int_eq(exit_code_of("train plan.yaml --threads 0"), 64);
  ck_assert_int_eq(exit_code_of("eval clip --paths 99999999999"), 64);
  ck_assert_int_eq(exit_code_of("eval hybrid:0=geo --law scene --count 100"), 64);
  ck_assert_int_eq(exit_code_of("datagen --list --swap nan"), 64);
  ck_assert_int_eq(exit_code_of("datagen --list --seed -1"), 64);
  ck_assert_int_eq(exit_code_of("datagen --list --seed 18446744073709551615"), 0);
  ck_assert_int_eq(exit_code_of("stress --quick --limit inf"), 64);
}
END_TEST

START_TEST(a_list_with_an_empty_name_is_a_usage_error_and_blanks_are_none) {
  const char *scene = TETLAP_SOURCE_DIR "/examples/02_two_blocks.yaml";
  static const char *const wrong[] = {"compare %s --overlap \"\"",
                                      "compare %s --overlap ,",
                                      "compare %s --overlap clip --audit-only ,",
                                      "bench overlap --model \"\"",
                                      "bench overlap -b 4,,8",
                                      "stress --quick --overlap \"\"",
                                      "datagen --list --mix ,",
                                      "bench overlap --model clip,cilp"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    char arguments[400];
    snprintf(arguments, sizeof arguments, wrong[i], scene);
    ck_assert_msg(exit_code_of(arguments) == 64, "tetlap %s", arguments);
  }
  ck_assert_int_eq(exit_code_of("bench overlap --model \"clip, exact\" --batch 8 --repeat 1 --set near"), 0);
}
END_TEST

// A short run into a scratch folder: whether its messages have a line of that form.
static bool run_says(const char *options, const char *line) {
  char command[768];
  snprintf(command, sizeof command,
           "folder=$(mktemp -d) && %s run %s/examples/01_drop.yaml --set time.end=0.01 -o $folder %s 2>&1 > "
           "/dev/null | "
           "grep -q '%s'; found=$?; rm -r $folder; exit $found",
           TETLAP_PROGRAM, TETLAP_SOURCE_DIR, options, line);
  int code = WEXITSTATUS(system(command));
  ck_assert_int_le(code, 1);
  return code == 0;
}

START_TEST(a_verbose_run_has_a_line_for_every_step) {
  static const char step[] = "^debug: t = .* s: step 1 of .* s, 0 pairs overlap$";
  ck_assert(run_says("-v", step));
  ck_assert(!run_says("", "^debug"));
}
END_TEST

START_TEST(a_run_names_the_files_that_it_wrote) {
  static const char end[] = "^ *end.h5, from which another scene may start$";
  ck_assert(run_says("", "^files: .*: frames.pvd (ParaView), history.csv, summary.json, manifest.json$"));
  ck_assert(run_says("--set output.vtu=false", "^files: *[^ ]*: history.csv, summary.json, manifest.json$"));
  ck_assert(run_says("--set output.history=none", "^files: *[^ ]*: frames.pvd (ParaView), summary.json"));
  ck_assert(run_says("", end));
  ck_assert(!run_says("--set output.checkpoint.frames=0", end));
}
END_TEST

// What that command prints on standard error.
static void read_messages(const char *arguments, char *text, size_t size) {
  char command[768];
  snprintf(command, sizeof command,
           "folder=$(mktemp -d) && cd $folder && %s %s 2>&1 > /dev/null; rm -r $folder", TETLAP_PROGRAM,
           arguments);
  FILE *stream = popen(command, "r");
  ck_assert_ptr_nonnull(stream);
  text[fread(text, 1, size - 1, stream)] = 0;
  ck_assert_int_eq(pclose(stream), 0);
}

static bool is_among(const char *word, size_t length, const char *const *words) {
  for (; *words; words++)
    if (strlen(*words) == length && memcmp(*words, word, length) == 0) return true;
  return false;
}

// A label or none in twelve columns, then one fact that fits a terminal and is no enumeration.
static void check_closing_line(const char *line, const char *const *labels) {
  size_t label = strcspn(line, " ");
  ck_assert_msg(label == 0 || is_among(line, label, labels), "'%s'", line);
  ck_assert_msg(strlen(line) > 13 && line[12] == ' ' && line[13] != ' ', "'%s'", line);
  ck_assert_msg(!strchr(line, ';'), "'%s'", line);
  if (strncmp(line, "trouble:", 8) != 0 && !strstr(line, "/"))
    ck_assert_msg(strlen(line) <= 100, "'%s'", line);
}

START_TEST(a_run_ends_in_lines_of_one_fact_each) {
  static const char *const labels[] = {"reached:", "steps:",      "overlaps:", "contact:", "network:",
                                       "energy:",  "statistics:", "files:",    "trouble:", NULL};
  static const char *const scenes[] = {
      "examples/02_two_blocks.yaml --set time.end=0.06 --set contact.overlap=clip",
      "examples/01_drop.yaml --set time.end=0.16 --set contact.overlap=tpn", "tests/scenes/patch.yaml"};
  char text[1 << 14], command[512];
  for (int k = 0; k < 3; k++) {
    snprintf(command, sizeof command, "run %s/%s -o out", TETLAP_SOURCE_DIR, scenes[k]);
    read_messages(command, text, sizeof text);
    char *line = strstr(text, "\nreached:"), *last = "";
    ck_assert_msg(line, "%s", text);
    int count = 0;
    for (line = strtok(line, "\n"); line; line = strtok(NULL, "\n"), count++)
      check_closing_line(last = line, labels);
    ck_assert_int_ge(count, 12);
    ck_assert_msg(strncmp(last, "trouble:     none", 17) == 0, "%s", last);
  }
}
END_TEST

START_TEST(training_in_a_pipe_tells_progress_in_lines) {
  char text[1 << 14];
  read_messages("train " TETLAP_SOURCE_DIR "/examples/train/smoke.yaml -o out --set optimiser.samples=5120",
                text, sizeof text);
  ck_assert_msg(strstr(text, "\n50 %: step 10 of 20, loss "), "%s", text);
  ck_assert_msg(strstr(text, "\n90 %: step 18 of 20, loss "), "%s", text);
  ck_assert_msg(!strchr(text, '\r') && !strstr(text, "nan"), "%s", text);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("program");
  tcase_add_test(cases, exit_codes_say_who_is_to_blame);
  tcase_add_test(cases, an_option_that_is_no_number_in_its_range_is_a_usage_error);
  tcase_add_test(cases, a_list_with_an_empty_name_is_a_usage_error_and_blanks_are_none);
  tcase_add_test(cases, a_verbose_run_has_a_line_for_every_step);
  tcase_add_test(cases, a_run_names_the_files_that_it_wrote);
  tcase_add_test(cases, a_run_ends_in_lines_of_one_fact_each);
  tcase_add_test(cases, training_in_a_pipe_tells_progress_in_lines);
  return suite_run("program", cases, 60);
}
