// SPDX-License-Identifier: GPL-3.0-or-later
// app/sweep: the values of an axis, and `tetlap sweep` as a whole.
#include "folder.h"

#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/sweep/axis.h"
#include "app/sweep/crew.h"
#include "app/sweep/history.h"
#include "app/sweep/order.h"
#include "app/sweep/point.h"
#include "base/files/file.h"
#include "base/files/record.h"
#include "base/memory.h"

static void expect_values(const char *text, const char *key, int count, const char *const *values) {
  AppSweepAxis axis;
  ck_assert_ok(app_sweep_axis_parse(&axis, text));
  ck_assert_str_eq(axis.key, key);
  ck_assert_int_eq(axis.value_count, count);
  for (int k = 0; k < count; k++) ck_assert_str_eq(axis.values[k], values[k]);
  app_sweep_axis_destroy(&axis);
}

START_TEST(ranges_have_both_ends_and_lists_their_words) {
  expect_values("contact.stiffness=1e5..1e9:5,log", "contact.stiffness", 5,
                (const char *const[]){"1e5", "1e6", "1e7", "1e8", "1e9"});
  expect_values("time.end=0.1..0.5:3", "time.end", 3, (const char *const[]){"0.1", "0.3", "0.5"});
  expect_values("a=-1..1:3", "a", 3, (const char *const[]){"-1", "0", "1"});
  expect_values("a=1...5:2", "a", 2, (const char *const[]){"1", "0.5"});
  expect_values("a=1e-5..1e-3:3,log", "a", 3, (const char *const[]){"1e-5", "0.0001", "0.001"});
  expect_values("contact.overlap=clip, geo", "contact.overlap", 2, (const char *const[]){"clip", "geo"});
  expect_values("v=[0, 1],\"a,b\",{x: 1, y: 2}", "v", 3,
                (const char *const[]){"[0, 1]", "\"a,b\"", "{x: 1, y: 2}"});
  expect_values("mesh=../a..b.msh", "mesh", 1, (const char *const[]){"../a..b.msh"});
}
END_TEST

// Two keys that change together and a third: 2 × 3 points, not 2 × 2 × 3.
START_TEST(linked_keys_change_together) {
  AppSweepBase base = {.scene_path = "s.yaml", .directory = "out", .repeat_count = 1};
  ck_assert_ok(app_sweep_axis_parse_linked(base.axes, APP_SWEEP_MAX_AXES, &base.axis_count,
                                           "a.cells=2,4 with b.cells=3,6"));
  ck_assert_ok(app_sweep_axis_parse_linked(base.axes, APP_SWEEP_MAX_AXES, &base.axis_count, "c=1..3:3"));
  ck_assert_int_eq(base.axis_count, 3);
  ck_assert_int_eq(app_sweep_point_count(&base), 6);
  for (int p = 0; p < 6; p++) {
    AppSweepPoint point;
    ck_assert_ok(app_sweep_point_create(&point, &base, p));
    ck_assert_str_eq(point.settings[0], p < 3 ? "a.cells=2" : "a.cells=4");
    ck_assert_str_eq(point.settings[1], p < 3 ? "b.cells=3" : "b.cells=6");
    ck_assert_int_eq(point.settings[2][2], '1' + p % 3);
    app_sweep_point_destroy(&point);
  }
  for (int a = 0; a < base.axis_count; a++) app_sweep_axis_destroy(&base.axes[a]);
  base.axis_count = 0;
  ck_assert_int_eq(
      app_sweep_axis_parse_linked(base.axes, APP_SWEEP_MAX_AXES, &base.axis_count, "a=1,2,3 with b=1,2"),
      STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), "'a' has 3 values and 'b', which changes with it, 2"));
  for (int a = 0; a < base.axis_count; a++) app_sweep_axis_destroy(&base.axes[a]);
}
END_TEST

START_TEST(cores_are_divided_among_runs) {
  const struct {
    int jobs, threads, count, jobs_are, threads_are;
  } cases[] = {{0, 0, 100, 12, 1}, {0, 0, 5, 5, 2}, {0, 0, 1, 1, 12},  {4, 0, 100, 4, 3},
               {0, 3, 100, 4, 3},  {2, 3, 9, 2, 3}, {0, 99, 9, 1, 99}, {24, 0, 100, 24, 1}};
  const int before = omp_get_max_threads();
  omp_set_num_threads(12);
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    const AppSweepShare share = app_sweep_crew_share(cases[k].jobs, cases[k].threads, cases[k].count);
    ck_assert_int_eq(share.jobs, cases[k].jobs_are);
    ck_assert_int_eq(share.threads, cases[k].threads_are);
  }
  omp_set_num_threads(before);
}
END_TEST

// f = 1 + 3 h², h = 1/n.
START_TEST(the_observed_order_of_a_quadratic_error_is_two) {
  const double f[3] = {1 + 3.0 / 4, 1 + 3.0 / 16, 1 + 3.0 / 64}, turns[3] = {1, 2, 1.5};
  const char *const finer[] = {"2", "4", "8"}, *const smaller[] = {"1e-2", "5e-3", "2.5e-3"};
  const char *const uneven[] = {"2", "4", "9"}, *const words[] = {"clip", "geo", "exact"};
  ck_assert_near(app_sweep_order_observed(finer, f), 2, 1e-12);
  ck_assert_near(app_sweep_order_observed(smaller, f), 2, 1e-12);
  ck_assert(isnan(app_sweep_order_observed(finer, turns)));
  ck_assert(isnan(app_sweep_order_observed(uneven, f)));
  ck_assert(isnan(app_sweep_order_observed(words, f)));
}
END_TEST

START_TEST(an_axis_that_makes_no_sense_is_a_usage_error) {
  static const char *const wrong[] = {"time.end",     "=1,2",           "a=",          "a=1,,2", "a=1..2:1",
                                      "a=0..1:3,log", "a=-2..-1:3,log", "a=1..2:1001", "a=1,2,1"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    AppSweepAxis axis;
    ck_assert_msg(app_sweep_axis_parse(&axis, wrong[i]) == STATUS_USAGE, "%s", wrong[i]);
    ck_assert_msg(strstr(status_message(), "--vary") != NULL, "%s", status_message());
  }
}
END_TEST

// A shell command in the folder.
static void change(const char *what) {
  char command[640];
  snprintf(command, sizeof command, "cd %s && %s", folder, what);
  ck_assert_int_eq(system(command), 0);
}

// The exit code; what is said goes to the file `said` in the folder above.
static int sweep_scene(const char *scene, const char *options) {
  char command[1024];
  snprintf(command, sizeof command,
           "%s sweep %s -o %s/out -s output.frames=4 -s output.vtu=false %s > %s/said 2>&1", TETLAP_PROGRAM,
           scene, folder, options, folder);
  return WEXITSTATUS(system(command));
}

static int sweep(const char *options) {
  return sweep_scene(TETLAP_SOURCE_DIR "/examples/01_drop.yaml", options);
}

static Record *read_table(void) {
  char path[256];
  Record *table;
  snprintf(path, sizeof path, "%s/out/sweep.json", folder);
  ck_assert_ok(record_read(&table, path));
  return table;
}

static bool says(const char *text) {
  char *said = folder_read("said");
  bool is_there = strstr(said, text) != NULL;
  memory_free(said);
  return is_there;
}

static const char *outcome_of(const Record *table, int k) {
  return record_find_text(record_at(record_find(table, "runs"), k), "outcome");
}

static int lines_of(const char *text) {
  int lines = 0;
  for (; *text; text++) lines += *text == '\n';
  return lines;
}

// In its row: of the forces of three runs along the second key, which is the first with three values.
START_TEST(the_files_hold_the_observed_order) {
  static const char grid[] =
      "-s time.end=0.15 -V bodies.upper.material.poisson=0.3,0.2 -V contact.stiffness=";
  char options[160];
  snprintf(options, sizeof options, "%s1e5,1e6,1e7", grid);
  ck_assert_int_eq(sweep_scene(TETLAP_SOURCE_DIR "/examples/02_two_blocks.yaml", options), 0);
  Record *table = read_table();
  const Record *runs = record_find(table, "runs");
  ck_assert_str_eq(record_find_text(table, "order_along"), "contact.stiffness");
  const char *const values[] = {"1e5", "1e6", "1e7"};
  double f[6];
  for (int k = 0; k < 6; k++) f[k] = record_find_number(record_at(runs, k), "contact_force_last_N");
  for (int k = 0; k < 6; k++) {
    double order = record_find_number(record_at(runs, k), "order");
    double expected = k % 3 == 2 ? app_sweep_order_observed(values, f + k - 2) : NAN;
    ck_assert(isnan(expected) ? isnan(order) : fabs(order - expected) <= 1e-12 * fabs(expected));
  }
  ck_assert(isfinite(record_find_number(record_at(runs, 2), "order")));
  record_destroy(table);
  snprintf(options, sizeof options, "%s1e5,1e6", grid); // two values have none
  ck_assert_int_eq(sweep_scene(TETLAP_SOURCE_DIR "/examples/02_two_blocks.yaml", options), 0);
  table = read_table();
  ck_assert_ptr_null(record_find_text(table, "order_along"));
  record_destroy(table);
}
END_TEST

// A value that a scene cannot have fails alone.
START_TEST(runs_are_rows_and_one_that_fails_is_a_row_too) {
  const char *grid = "-s time.end=0.02 -V bodies[0].material.poisson=0.3,0.7 -V contact.stiffness=1e5,1e6";
  ck_assert_int_eq(sweep(grid), 70);
  Record *table = read_table();
  const Record *runs = record_find(table, "runs");
  ck_assert_str_eq(record_find_text(table, "format"), "tetlap-sweep 1");
  ck_assert_int_eq(record_count(runs), 4);
  for (int k = 0; k < 4; k++) {
    const Record *row = record_at(runs, k), *set = record_find(row, "set");
    ck_assert_str_eq(record_find_text(row, "outcome"), k < 2 ? "finished" : "failed");
    ck_assert_near(record_find_number(row, "exit_code"), k < 2 ? 0 : 64, 0);
    ck_assert_near(record_find_number(set, "contact.stiffness"), k % 2 ? 1e6 : 1e5, 0);
    if (k < 2)
      ck_assert_near(record_find_number(row, "end_time_s"), 0.02, 1e-12);
    else
      ck_assert_ptr_nonnull(strstr(record_find_text(row, "message"), "poisson"));
  }
  record_destroy(table);
  // what is counted has no decimal point
  char *json = folder_read("out/sweep.json"), *steps = strstr(json, "\"steps\": ");
  ck_assert_ptr_nonnull(steps);
  steps += strlen("\"steps\": ");
  ck_assert_int_eq(steps[strspn(steps, "0123456789")], ',');
  memory_free(json);

  char *csv = folder_read("out/sweep.csv");
  ck_assert_int_eq(lines_of(csv), 5);
  ck_assert_ptr_nonnull(strstr(csv, "folder,bodies[0].material.poisson,contact.stiffness,outcome,"));
  memory_free(csv);
  char *page = folder_read("out/sweep.html");
  ck_assert_ptr_nonnull(strstr(page, "tetlap-sweep 1"));
  memory_free(page);
}
END_TEST

// In turns: all values once, then all again. Every run is a row of the files, every combination one of the
// terminal.
START_TEST(repeated_runs_are_rows_and_their_medians_a_table) {
  ck_assert_int_eq(sweep("-r 3 -J 1 -s time.end=0.01 -V contact.stiffness=1e5,1e6 --markdown -q"), 0);
  Record *table = read_table();
  const Record *runs = record_find(table, "runs");
  ck_assert_int_eq(record_count(runs), 6);
  for (int k = 0; k < 6; k++) {
    const Record *row = record_at(runs, k);
    ck_assert_near(record_find_number(row, "repeat"), k / 2 + 1, 0);
    ck_assert_near(record_find_number(record_find(row, "set"), "contact.stiffness"), k % 2 ? 1e6 : 1e5, 0);
    ck_assert_near(record_find_number(row, "steps"), record_find_number(record_at(runs, k % 2), "steps"), 0);
    ck_assert_double_gt(record_find_number(row, "factorisation_s"), 0);
  }
  record_destroy(table);
  char *csv = folder_read("out/sweep.csv"), *said = folder_read("said");
  ck_assert_ptr_nonnull(strstr(csv, "folder,contact.stiffness,repeat,outcome,"));
  ck_assert_int_eq(lines_of(csv), 7);
  ck_assert_msg(lines_of(said) == 4 && strstr(said, " spread |"), "%s", said); // heads, rule, two rows
  memory_free(csv), memory_free(said);
  ck_assert_int_eq(sweep("-r 2 -s time.end=0.01"), 0); // nothing varies
  table = read_table();
  ck_assert_int_eq(record_count(record_find(table, "runs")), 2);
  record_destroy(table);
}
END_TEST

// A folder where the second run wants to write a file.
START_TEST(a_repeated_run_that_fails_is_told_in_its_row) {
  change("mkdir -p 'out/run,repeat=2/summary.json/taken'");
  ck_assert_int_eq(sweep("-r 3 -J 1 -s time.end=0.002"), 70);
  Record *table = read_table();
  for (int k = 0; k < 3; k++) ck_assert_str_eq(outcome_of(table, k), k == 1 ? "failed" : "finished");
  record_destroy(table);
  char *said = folder_read("said"), *row = strstr(said, "\nrun "), outcome[16];
  ck_assert_msg(row && (row = strstr(row + 1, "\nrun ")) != NULL, "%s", said); // below the heads
  ck_assert_int_eq(sscanf(row, " run %15s", outcome), 1);
  ck_assert_str_eq(outcome, "failed");
  ck_assert_msg(strstr(row, "summary.json") != NULL, "%s", said);
  memory_free(said);
}
END_TEST

START_TEST(what_is_finished_is_kept_and_what_has_changed_runs_again) {
  ck_assert_int_eq(sweep("-s time.end=0.01 -V contact.stiffness=1e5,1e6"), 0);
  ck_assert(says("0 finished, 0 to continue, 2 new"));
  ck_assert_int_eq(sweep("-s time.end=0.01 -V contact.stiffness=1e5,1e6,1e7"), 0);
  ck_assert(says("2 finished, 0 to continue, 1 new"));
  ck_assert_int_eq(sweep("-s time.end=0.012 -V contact.stiffness=1e5,1e6"), 0);
  ck_assert(says("0 finished, 0 to continue, 2 new"));
  Record *table = read_table();
  ck_assert_int_eq(record_count(record_find(table, "runs")), 2);
  record_destroy(table);
}
END_TEST

// What the scene file only names: the mesh of a body, the weights of the overlap model. Times of files say
// nothing; a mesh written anew with the same content is the same.
START_TEST(a_changed_mesh_or_changed_weights_run_again) {
  static const char scene[] =
      "title: t\ntime: {end: 0.002}\nbodies:\n"
      "  - {name: a, mesh: m.msh, material: {law: neo_hookean, young: 1e5, poisson: 0.3, density: 1000}}\n"
      "obstacles:\n  - {name: ground, halfspace: {point: [0, 0, -1], normal: [0, 0, 1]}}\n"
      "contact: {overlap: w.safetensors}\n";
  static const char kept[] = "1 finished, 0 to continue, 0 new", begun[] = "0 finished, 0 to continue, 1 new";
  static const struct {
    const char *change, *said;
  } cases[] = {
      {"true", kept},
      {"cp m.msh n.msh && mv n.msh m.msh && touch -d tomorrow m.msh", kept},
      {"cp " TETLAP_SOURCE_DIR "/meshes/sphere.msh m.msh && touch -d 2001-01-01 m.msh", begun},
      {"true", kept},
      {"cp " TETLAP_SOURCE_DIR
       "/net/weights/geo-small.safetensors w.safetensors && touch -d 2001-01-01 w.safetensors",
       begun},
      {"true", kept},
  };
  char path[128];
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fputs(scene, writer.stream);
  ck_assert_ok(file_commit(&writer));
  change("cp " TETLAP_SOURCE_DIR "/meshes/block.msh m.msh && cp " TETLAP_SOURCE_DIR
         "/net/weights/geo.safetensors w.safetensors");
  ck_assert_int_eq(sweep_scene(path, "-V bodies[0].material.young=1e5"), 0);
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    change(cases[k].change);
    ck_assert_int_eq(sweep_scene(path, "-V bodies[0].material.young=1e5"), 0);
    ck_assert_msg(says(cases[k].said), "%s", cases[k].change);
  }
}
END_TEST

// Of the run that the scene starts from; its folder is seen from the scene.
START_TEST(a_changed_end_state_runs_again) {
  static const char scene[] =
      "time: {end: 0.002}\nbodies:\n"
      "  - {name: a, mesh: {box: {size: [1, 1, 1], cells: 1}}, material: {law: neo_hookean, young: 1e5, "
      "poisson: 0.3, density: 1000}}\n";
  char path[128], first[128];
  snprintf(first, sizeof first, "%s/first.yaml", folder);
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, first));
  fputs(scene, writer.stream);
  ck_assert_ok(file_commit(&writer));
  change("cp first.yaml scene.yaml && echo 'start: first' >> scene.yaml");
  change(TETLAP_PROGRAM " run first.yaml -o first -q");
  ck_assert_int_eq(sweep_scene(path, "-V bodies[0].material.young=1e5"), 0);
  ck_assert_int_eq(sweep_scene(path, "-V bodies[0].material.young=1e5"), 0);
  ck_assert(says("1 finished, 0 to continue, 0 new"));
  change(TETLAP_PROGRAM " run first.yaml -o first -q --set time.end=0.003");
  ck_assert_int_eq(sweep_scene(path, "-V bodies[0].material.young=1e5"), 0);
  ck_assert(says("0 finished, 0 to continue, 1 new"));
}
END_TEST

// Paths are relative to the scene. The names are those of compare.
START_TEST(weights_files_have_the_names_of_models) {
  static const char scene[] =
      "title: t\ntime: {end: 0.002}\nbodies:\n"
      "  - {name: a, mesh: m.msh, material: {law: neo_hookean, young: 1e5, poisson: 0.3, density: 1000}}\n"
      "obstacles:\n  - {name: ground, halfspace: {point: [0, 0, -1], normal: [0, 0, 1]}}\n"
      "contact: {overlap: geo}\n";
  char path[128], file[128];
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fputs(scene, writer.stream);
  ck_assert_ok(file_commit(&writer));
  change("mkdir A B && cp " TETLAP_SOURCE_DIR "/meshes/block.msh m.msh && cp " TETLAP_SOURCE_DIR
         "/net/weights/geo.safetensors A/1.safetensors && cp " TETLAP_SOURCE_DIR
         "/net/weights/geo-small.safetensors B/1.safetensors");
  ck_assert_int_eq(sweep_scene(path, "-V contact.overlap=A/1.safetensors,./B/1.safetensors"), 0);
  ck_assert_msg(says("contact.overlap=A/1") && says("contact.overlap=B/1"), "the table of the terminal");
  Record *table = read_table();
  const Record *axis = record_at(record_find(table, "axes"), 0), *runs = record_find(table, "runs");
  const char *names[] = {"A/1", "B/1"};
  for (int k = 0; k < 2; k++) {
    snprintf(file, sizeof file, "%s/%s.safetensors", folder, names[k]);
    ck_assert_str_eq(record_text_value(record_at(record_find(axis, "values"), k)), names[k]);
    ck_assert_str_eq(record_text_value(record_at(record_find(axis, "weights"), k)), file);
    ck_assert_str_eq(record_find_text(record_find(record_at(runs, k), "set"), "contact.overlap"), names[k]);
  }
  record_destroy(table);
  char *csv = folder_read("out/sweep.csv");
  ck_assert_ptr_nonnull(strstr(csv, ",A/1,finished,"));
  memory_free(csv);
  ck_assert_int_eq(sweep_scene(path, "-V contact.overlap=A/1.safetensors,./A/1.safetensors"), 64);
  ck_assert(says("named twice"));
}
END_TEST

START_TEST(a_table_of_another_format_is_refused_and_kept) {
  ck_assert_int_eq(sweep("-s time.end=0.002 -V bodies[0].material.poisson=0.3"), 0);
  change("sed -i 's/tetlap-sweep 1/tetlap-sweep 0/' out/sweep.json && cp out/sweep.json before.json");
  ck_assert_int_eq(sweep("-s time.end=0.002 -V bodies[0].material.poisson=0.3"), 65);
  ck_assert(says("is of format 'tetlap-sweep 0', written by tetlap "));
  change("cmp out/sweep.json before.json");
}
END_TEST

// Two bodies' keys that end alike, in two sweeps into one folder.
START_TEST(other_keys_have_other_folders) {
  ck_assert_int_eq(sweep("-s time.end=0.002 -V bodies[0].material.poisson=0.3"), 0);
  change("mv out/sweep.json before.json");
  ck_assert_int_eq(sweep("-s time.end=0.002 -V bodies.block.material.poisson=0.3"), 0);
  Record *table = read_table(), *before;
  char path[128];
  snprintf(path, sizeof path, "%s/before.json", folder);
  ck_assert_ok(record_read(&before, path));
  const char *one = record_find_text(record_at(record_find(table, "runs"), 0), "folder"),
             *other = record_find_text(record_at(record_find(before, "runs"), 0), "folder");
  ck_assert(one && other && strcmp(one, other) != 0);
  record_destroy(table);
  record_destroy(before);
}
END_TEST

// What an earlier process left in the log is not told of the later one, which says nothing.
START_TEST(a_message_is_the_own_process_s) {
  const char *grid = "-s time.end=0.002 -V bodies.block.material.poisson=0.3,0.7";
  ck_assert_int_eq(sweep(grid), 70);
  ck_assert(says("0 finished, 0 to continue, 1 new")); // one that cannot be read is not there
  ck_assert(says("1 of them cannot be run"));
  change("cd out/bodies.block.material.poisson=0.3 && rm summary.json && mkdir -p summary.json/taken && "
         "echo 'tetlap: error: of yesterday' > log.txt");
  ck_assert_int_eq(sweep(grid), 70);
  Record *table = read_table();
  const Record *row = record_at(record_find(table, "runs"), 0);
  ck_assert_str_eq(record_find_text(row, "outcome"), "failed");
  const char *message = record_find_text(row, "message");
  ck_assert(message && !strstr(message, "yesterday") && strstr(message, "summary.json"));
  record_destroy(table);
}
END_TEST

START_TEST(a_wrong_key_is_told_at_once) {
  ck_assert_int_eq(sweep("-V contact.stifness=1,2"), 64);
  ck_assert(says("did you mean 'stiffness'"));
  ck_assert_int_eq(sweep("-V contact.stiffness=1,2 -V contact.stiffness=3,4"), 64);
  ck_assert(says("is given twice"));
  ck_assert_int_eq(sweep(""), 64);
  ck_assert_int_eq(sweep("-V a=1..1000:1000 -V b=1..1000:1000"), 64);
  char path[128];
  snprintf(path, sizeof path, "%s/out", folder);
  ck_assert(!file_exists(path)); // nothing was begun
}
END_TEST

// Times rise, forces are the largest of the rows that an entry stands for, and nothing is lost or invented.
START_TEST(a_history_is_thinned_by_its_peaks) {
  char path[128];
  AppSweepHistory history;
  snprintf(path, sizeof path, "%s/history.csv", folder);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs("time_s,x,contact_force_peak_N\n", file);
  for (int k = 0; k < 999; k++) fprintf(file, "%g,-1,%d\n", 0.001 * k, k == 637 ? 50 : k % 7);
  fputs("1,", file); // cut short
  ck_assert_int_eq(fclose(file), 0);
  ck_assert_ok(app_sweep_history_read(&history, folder));
  ck_assert_int_eq(history.count, 100);
  for (int k = 0; k < 100; k++) {
    ck_assert_near(history.time[k], 0.001 * (k == 99 ? 998 : 10 * k + 9), 1e-12);
    ck_assert_near(history.force[k], k == 63 ? 50 : 6, 0); // seven rows in a row have all remainders
  }
  ck_assert_ok(app_sweep_history_read(&history, "/nowhere"));
  ck_assert_int_eq(history.count, 0);
}
END_TEST

static pid_t start_sweep(const char *out) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, out);
  pid_t child = fork();
  if (child == 0) {
    freopen("/dev/null", "w", stdout);
    freopen("/dev/null", "w", stderr);
    execl(TETLAP_PROGRAM, "tetlap", "sweep", TETLAP_SOURCE_DIR "/examples/02_two_blocks.yaml", "-o", path,
          "-J", "2", "-V", "contact.stiffness=1e5,2e5,4e5", "-s", "output.vtu=false", "-s",
          "output.frames=40", "-s", "output.checkpoint=2", "-s", "time.end=0.15", (char *)NULL);
    _exit(127);
  }
  ck_assert_int_gt(child, 0);
  return child;
}

static int wait_for(pid_t child) {
  int state;
  ck_assert_int_eq(waitpid(child, &state, 0), child);
  return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

static char *history_of(const char *out, const char *run) {
  char name[128];
  snprintf(name, sizeof name, "%s/%s/history.csv", out, run);
  return folder_read(name);
}

// Stopped when both first runs are at work, and gone on with: the same histories, to the last bit.
START_TEST(a_sweep_that_is_interrupted_goes_on_as_if_it_had_not_been) {
  static const char *const runs[] = {"contact.stiffness=1e5", "contact.stiffness=2e5",
                                     "contact.stiffness=4e5"};
  char started[160];
  snprintf(started, sizeof started, "%s/cut/%s/history.csv", folder, runs[1]);
  pid_t child = start_sweep("cut");
  for (int k = 0; k < 3000 && !file_exists(started); k++)
    nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
  ck_assert_int_eq(kill(child, SIGINT), 0);
  ck_assert_int_eq(wait_for(child), 130);
  Record *table;
  char path[128];
  snprintf(path, sizeof path, "%s/cut/sweep.json", folder);
  ck_assert_ok(record_read(&table, path));
  ck_assert_str_eq(outcome_of(table, 2), "waiting");
  record_destroy(table);

  ck_assert_int_eq(wait_for(start_sweep("cut")), 0);
  ck_assert_int_eq(wait_for(start_sweep("whole")), 0);
  for (int k = 0; k < 3; k++) {
    char *cut = history_of("cut", runs[k]), *whole = history_of("whole", runs[k]);
    ck_assert_ptr_nonnull(strstr(cut, "\n"));
    ck_assert_msg(strcmp(cut, whole) == 0, "%s", runs[k]);
    memory_free(cut);
    memory_free(whole);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("sweep");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, linked_keys_change_together);
  tcase_add_test(cases, cores_are_divided_among_runs);
  tcase_add_test(cases, the_observed_order_of_a_quadratic_error_is_two);
  tcase_add_test(cases, the_files_hold_the_observed_order);
  tcase_add_test(cases, ranges_have_both_ends_and_lists_their_words);
  tcase_add_test(cases, an_axis_that_makes_no_sense_is_a_usage_error);
  tcase_add_test(cases, runs_are_rows_and_one_that_fails_is_a_row_too);
  tcase_add_test(cases, repeated_runs_are_rows_and_their_medians_a_table);
  tcase_add_test(cases, a_repeated_run_that_fails_is_told_in_its_row);
  tcase_add_test(cases, what_is_finished_is_kept_and_what_has_changed_runs_again);
  tcase_add_test(cases, a_changed_mesh_or_changed_weights_run_again);
  tcase_add_test(cases, a_changed_end_state_runs_again);
  tcase_add_test(cases, other_keys_have_other_folders);
  tcase_add_test(cases, weights_files_have_the_names_of_models);
  tcase_add_test(cases, a_table_of_another_format_is_refused_and_kept);
  tcase_add_test(cases, a_message_is_the_own_process_s);
  tcase_add_test(cases, a_history_is_thinned_by_its_peaks);
  tcase_add_test(cases, a_wrong_key_is_told_at_once);
  tcase_add_test(cases, a_sweep_that_is_interrupted_goes_on_as_if_it_had_not_been);
  return suite_run("sweep", cases, 60);
}
