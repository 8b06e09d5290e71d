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
  kept->result.trajectory = (FemRunTrajectory){.frame_count = frame_count,
                                               .vertex_count = 1,
                                               .interface_count = 1,
                                               .interface_forces = kept->forces,
                                               .positions = kept->trajectory};
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

static ContactAudit state_of(double difference, double size) {
  ContactAuditTerm term = {difference, size};
  return (ContactAudit){.volume = term, .gradient = term, .force = term, .total = term, .pair_count = 3};
}

// Of forces that begin at next to nothing the first state has any relative error.
START_TEST(audited_states_weigh_by_their_size) {
  AppAudit audit = {0};
  AppAuditFigure figure;
  ContactAudit onset = state_of(5, 1e-9), later = state_of(0.7, 100), none = {0};
  ck_assert_ok(app_audit_add(&audit, 0.01, &none)); // no two elements overlap: no state
  ck_assert_ok(app_audit_figure(&audit, APP_AUDIT_FORCE, &figure));
  ck_assert(isnan(figure.error) && isnan(figure.median) && isnan(figure.worst) && isnan(figure.worst_time));
  ck_assert_ok(app_audit_add(&audit, 0.02, &later));
  ck_assert_ok(app_audit_add(&audit, 0.03, &onset));
  for (int i = 0; i < 8; i++) ck_assert_ok(app_audit_add(&audit, 0.04, &later));
  ck_assert_int_eq(audit.count, 10);
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    ck_assert_ok(app_audit_figure(&audit, (AppAuditKind)k, &figure));
    ck_assert_near(figure.error, (5 + 9 * 0.7) / 900, 1e-9);
    ck_assert_near(figure.median, 0.007, 1e-15);
    ck_assert_near(figure.worst, 5e9, 1e-3);
    ck_assert_near(figure.worst_time, 0.03, 0);
  }
  memory_free(audit.rows);
}
END_TEST

// What a command prints, both streams.
static int print(const char *words, char *text, size_t size) {
  char command[1024];
  snprintf(command, sizeof command, "{ %s %s ; } 2>&1", TETLAP_PROGRAM, words);
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

// A geo-small that moves two crossing edges takes a third more steps than clip.
START_TEST(a_run_of_too_many_steps_is_cut_at_so_many_times_the_reference) {
  static char text[1 << 16];
  char folder[] = "/tmp/tetlap_compare_XXXXXX", words[512];
  Record *list;
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "compare " TETLAP_SOURCE_DIR
           "/examples/verdict/edge.yaml --overlap geo-small,clip --reference clip "
           "--most-steps 1.2 --audit 0 -t 1 -o %s --set output.vtu=false",
           folder);
  ck_assert_int_eq(print(words, text, sizeof text), 70);
  snprintf(words, sizeof words, "%s/compare.json", folder);
  ck_assert_ok(record_read(&list, words));
  snprintf(words, sizeof words, "rm -r %s", folder);
  ck_assert_int_eq(system(words), 0);
  const Record *cut = record_at(list, 0), *reference = record_at(list, 1);
  ck_assert_str_eq(record_find_text(cut, "outcome"), "cut short");
  ck_assert_ptr_nonnull(strstr(record_find_text(cut, "message"), "cut short by --most-steps"));
  ck_assert_str_eq(record_find_text(reference, "outcome"), "finished");
  ck_assert_near(record_find_number(record_find(cut, "summary"), "steps"),
                 floor(1.2 * record_find_number(record_find(reference, "summary"), "steps")) + 1, 0);
  record_destroy(list);
}
END_TEST

// A folder with two networks of one base name, and a scene of two blocks that names one of them.
static char home[64], run_text[1 << 16];

static void run_shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void run_shell(const char *format, ...) {
  char command[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(command, sizeof command, format, arguments);
  va_end(arguments);
  ck_assert_msg(system(command) == 0, "%s", command);
}

static void make_home(void) {
  snprintf(home, sizeof home, "/tmp/tetlap_compare_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(home));
  run_shell("cd %s && mkdir a b && cp " TETLAP_SOURCE_DIR
            "/net/weights/geo-small.safetensors a/net.safetensors && "
            "cp " TETLAP_SOURCE_DIR "/net/weights/geo.safetensors b/net.safetensors && "
            "sed 's|^contact:.*|contact: {overlap: a/net.safetensors}|' " TETLAP_SOURCE_DIR
            "/examples/02_two_blocks.yaml > scene.yaml",
            home);
}

static void remove_home(void) {
  run_shell("rm -r %s", home);
}

static const char SHORT[] = "-t 1 -s output.vtu=false -s output.frames=2 -s time.end=0.11";

// Runs the program in that folder, as a user would.
static void run_there(const char *words) {
  char command[1024];
  snprintf(command, sizeof command, "cd %s && %s %s %s 2>&1", home, TETLAP_PROGRAM, words, SHORT);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t count = fread(run_text, 1, sizeof run_text - 1, pipe);
  run_text[count] = 0;
  ck_assert_msg(pclose(pipe) == 0, "%s", run_text);
}

static Record *read_there(const char *folder, const char *name) {
  char path[256];
  Record *record;
  snprintf(path, sizeof path, "%s/%s/%s", home, folder, name);
  ck_assert_ok(record_read(&record, path));
  return record;
}

static void check_text(const Record *record, const char *key, const char *expected) {
  const char *found = record_find_text(record, key);
  ck_assert_msg(found && strcmp(found, expected) == 0, "%s: %s, not %s", key, found ? found : "none",
                expected);
}

// The run of a network has its own folder, and says whose it is.
static void check_run_of(const char *folder, const char *name) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s.safetensors", home, name);
  Record *summary = read_there(folder, "summary.json"), *manifest = read_there(folder, "manifest.json");
  check_text(summary, "overlap", name);
  check_text(summary, "weights", path);
  check_text(summary, "potential", "field");
  check_text(record_find(manifest, "inputs"), "weights_file", path);
  record_destroy(summary), record_destroy(manifest);
}

START_TEST(two_networks_of_one_base_name_share_neither_folder_nor_name) {
  make_home();
  run_there("compare scene.yaml --overlap clip,a/net.safetensors,b/net.safetensors -o out --reference b/net");
  check_run_of("out/a/net", "a/net");
  check_run_of("out/b/net", "b/net");
  Record *rows = read_there("out", "compare.json");
  static const char *const names[] = {"clip", "a/net", "b/net"};
  ck_assert_int_eq(record_count(rows), 3);
  for (int k = 0; k < 3; k++) {
    check_text(record_at(rows, k), "model", names[k]);
    check_text(record_at(rows, k), "reference", "b/net");
  }
  record_destroy(rows);
  remove_home();
}
END_TEST

// What differs between two runs is where they were written and how the file was named.
START_TEST(a_weights_file_means_the_same_on_the_command_line_and_in_the_scene) {
  static const char *const keys[] = {"overlap", "weights", "potential"};
  static const char *const numbers[] = {"steps", "contact_force_max", "pairs_max"};
  make_home();
  run_there("run scene.yaml -o by-scene");
  ck_assert_ptr_nonnull(strstr(run_text, "net ("));
  ck_assert_ptr_nonnull(strstr(run_text, "potential field"));
  run_there("run scene.yaml -m ./b/../a/net.safetensors -s contact={} -o by-option");
  Record *a = read_there("by-scene", "summary.json"), *b = read_there("by-option", "summary.json");
  for (int k = 0; k < 3; k++) check_text(b, keys[k], record_find_text(a, keys[k]));
  for (int k = 0; k < 3; k++)
    ck_assert(record_find_number(a, numbers[k]) == record_find_number(b, numbers[k]));
  ck_assert(record_find_number(a, "contact_force_max") > 0);
  record_destroy(a), record_destroy(b);
  remove_home();
}
END_TEST

// Compares clip and exact; what is told, and compare.json, NULL: not asked for.
static void compare(const char *words, char *text, size_t size, Record **list) {
  char folder[] = "/tmp/tetlap_compare_XXXXXX", command[1024];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(command, sizeof command,
           "compare " TETLAP_SOURCE_DIR "/%s -o %s --overlap clip,exact -s output.vtu=false", words, folder);
  ck_assert_int_eq(print(command, text, size), 0);
  snprintf(command, sizeof command, "%s/compare.json", folder);
  ck_assert_ok(record_read(list, command));
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

// A half-space has no elements: no model is asked, so none can be judged by it.
START_TEST(contact_with_obstacles_alone_has_no_audit) {
  static char text[1 << 16];
  Record *list;
  compare("examples/01_drop.yaml -s time.end=0.3 --audit 1", text, sizeof text, &list);
  ck_assert_msg(strstr(text, "audit: –; contact is with obstacles without elements only") != NULL, "%s",
                text);
  const Record *exact = record_at(list, 1);
  ck_assert_near(record_find_number(exact, "audits"), 0, 0);
  ck_assert(isnan(record_find_number(exact, "audit_force_error")));
  ck_assert(isnan(record_find_number(exact, "audit_force_error_worst")));
  ck_assert_ptr_nonnull(strstr(record_find_text(exact, "audit_told"), "use no overlap model"));
  ck_assert(record_find_number(record_find(exact, "summary"), "contact_force_max") > 0);
  record_destroy(list);
  ck_assert_int_eq(print("run " TETLAP_SOURCE_DIR "/examples/01_drop.yaml -s time.end=0.01 -s "
                         "output.vtu=false -o /tmp/tetlap_compare_alone && rm -r /tmp/tetlap_compare_alone",
                         text, sizeof text),
                   0);
  ck_assert_msg(strstr(text, "its forces use no overlap model") != NULL, "%s", text);
}
END_TEST

START_TEST(an_audit_of_few_states_says_so) {
  static char text[1 << 16];
  Record *list;
  compare("tests/scenes/onset.yaml --audit 1000", text, sizeof text, &list);
  ck_assert_msg(strstr(text, "audited, which is few") != NULL, "%s", text);
  const Record *exact = record_at(list, 1);
  ck_assert_near(record_find_number(exact, "audits"), 1, 0);
  ck_assert(record_find_number(exact, "audit_force_error") < 1e-6);
  ck_assert(record_find_number(exact, "audit_force_error_worst_time") > 0);
  record_destroy(list);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("compare");
  tcase_add_test(cases, errors_are_over_the_frames_that_both_have_reached);
  tcase_add_test(cases, a_run_that_fails_before_it_touches_has_no_force_error);
  tcase_add_test(cases, audited_states_weigh_by_their_size);
  tcase_add_test(cases, a_run_that_takes_too_long_is_cut_and_looks_it);
  tcase_add_test(cases, a_run_of_too_many_steps_is_cut_at_so_many_times_the_reference);
  tcase_add_test(cases, two_networks_of_one_base_name_share_neither_folder_nor_name);
  tcase_add_test(cases, a_weights_file_means_the_same_on_the_command_line_and_in_the_scene);
  tcase_add_test(cases, contact_with_obstacles_alone_has_no_audit);
  tcase_add_test(cases, an_audit_of_few_states_says_so);
  return suite_run("compare", cases, 120);
}
