// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap stress`: the quick part of the hard cases holds, and the table says what is not so.
#include "suite.h"

#include <string.h>

#include "app/stress/all.h"
#include "app/stress/limits.h"
#include "app/stress/linking.h"
#include "app/stress/pairs/traits.h"
#include "app/stress/scenes.h"
#include "app/stress/stress.h"
#include "base/memory.h"
#include "datagen/hard.h"
#include "overlap/models.h"

static void run(AppStress *stress, const AppStressOptions *options) {
  Status status = app_stress_all_run(options, stress);
  ck_assert_msg(status == STATUS_OK, "%s", status_message());
}

// No row fails, and every row asserts that its case did occur.
static void expect_no_failure(const AppStress *stress) {
  for (int r = 0; r < stress->count; r++) {
    const AppStressRow *row = &stress->rows[r];
    bool has_occurred = row->outcome == APP_STRESS_ABSENT;
    for (int m = 0; m < row->measure_count; m++)
      if (row->measures[m].is_occurrence) has_occurred = row->measures[m].is_met;
    ck_assert_msg(has_occurred, "%s, %s: did not occur", row->name, row->model);
    if (row->outcome == APP_STRESS_FAILED) app_stress_print(stress, stdout);
    ck_assert_msg(row->outcome != APP_STRESS_FAILED, "%s, %s failed: %s", row->name, row->model, row->remark);
  }
}

START_TEST(every_class_of_pairs_holds_with_every_model) {
  AppStress stress;
  int count;
  overlap_models_list(&count);
  char all[512] = "";
  for (int m = 0; m < count; m++) {
    const char *name = overlap_models_list(&count)[m]->name;
    if (strcmp(name, "cgal") == 0) continue; // milliseconds a pair: the long run has it
    strcat(strcat(all, all[0] ? "," : ""), name);
  }
  run(&stress, &(AppStressOptions){.has_pairs = true, .is_quick = true, .models = all});
  ck_assert_int_eq(stress.count, (count - 1) * (DATAGEN_HARD_CLASS_COUNT + 1));
  expect_no_failure(&stress);
  app_stress_destroy(&stress);
}
END_TEST

// The weights of `geo` as a file: its own name, the measures and the verdict of `geo`.
START_TEST(the_pairs_of_a_weights_file_are_measured_under_its_name) {
  static const char models[] = "geo," TETLAP_SOURCE_DIR "/net/weights/geo.safetensors";
  AppStress stress;
  run(&stress, &(AppStressOptions){.has_pairs = true, .is_quick = true, .only = "uniform", .models = models});
  ck_assert_int_ge(stress.count, 2);
  ck_assert_int_eq(stress.count % 2, 0);
  for (int r = 0; r < stress.count / 2; r++) {
    const AppStressRow *own = &stress.rows[r], *file = &stress.rows[stress.count / 2 + r];
    ck_assert_str_eq(own->model, "geo");
    ck_assert_str_eq(file->model, "weights/geo");
    ck_assert_str_eq(file->name, own->name);
    ck_assert_int_eq(file->outcome, own->outcome);
    ck_assert_int_eq(file->measure_count, own->measure_count);
    for (int m = 0; m < own->measure_count; m++)
      ck_assert_double_eq(file->measures[m].value, own->measures[m].value);
  }
  expect_no_failure(&stress);
  app_stress_destroy(&stress);
}
END_TEST

START_TEST(the_quick_scenes_hold) {
  AppStress stress;
  run(&stress, &(AppStressOptions){.has_scenes = true, .is_quick = true});
  ck_assert_int_ge(stress.count, 20);
  ck_assert_int_eq(app_stress_count(&stress, APP_STRESS_ABSENT), 0);
  expect_no_failure(&stress);
  app_stress_destroy(&stress);
}
END_TEST

START_TEST(a_name_picks_cases_and_an_unknown_one_is_an_error) {
  AppStress stress;
  run(&stress, &(AppStressOptions){.has_pairs = true, .is_quick = true, .only = "sliver", .models = "exact"});
  ck_assert_int_eq(stress.count, 2);
  app_stress_destroy(&stress);
  ck_assert_int_eq(app_stress_all_run(&(AppStressOptions){.has_pairs = true, .only = "no such"}, &stress),
                   STATUS_USAGE);
  app_stress_destroy(&stress);
}
END_TEST

START_TEST(a_verdict_follows_from_the_measures) {
  AppStressRow row = {.group = "scenes", .name = "nameless", .model = "clip"};
  app_stress_ask_most(&row, "small", 1, 2);
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_HELD);
  app_stress_ask_least(&row, "large", NAN, 2);
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_FAILED);
  const AppStressLimit *limit = app_stress_limits_find("two spheres", "clip", "change of angular momentum");
  ck_assert_ptr_nonnull(limit);
  row = (AppStressRow){.group = "scenes", .name = limit->name, .model = "clip"};
  app_stress_ask_most(&row, limit->measure, limit->worst / 2, 0);
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_LIMIT);
  ck_assert_str_eq(row.remark, limit->reason);
  row.measures[0].is_met = true;
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_BETTER);
  row.measure_count = 0;
  app_stress_ask_most(&row, limit->measure, 2 * limit->worst, 0); // a limit is measured, too
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_FAILED);
  row.measure_count = 0;
  app_stress_ask_occurred(&row, "contact", 0, 1); // a limit excuses no case that did not occur
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_FAILED);
}
END_TEST

// What needs a run's end cannot be asked of one that was cut; all else can.
START_TEST(a_run_that_was_cut_is_a_limit_but_still_judged_by_what_it_did) {
  AppStressRow row = {.group = "scenes", .name = "nameless", .model = "clip", .is_cut = true};
  app_stress_ask_occurred(&row, "contact", 0, 1);
  app_stress_ask_end(&row, 1, 2);
  app_stress_ask_most(&row, "energy gain", 1e-4, 1e-3);
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_LIMIT);
  app_stress_ask_most(&row, "energy gain", 1e-2, 1e-3);
  app_stress_judge(&row);
  ck_assert_int_eq(row.outcome, APP_STRESS_FAILED);
}
END_TEST

START_TEST(a_limit_of_work_cuts_a_scene_and_says_how_far_it_came) {
  AppStress stress;
  run(&stress,
      &(AppStressOptions){.has_scenes = true, .only = "stack of 10", .models = "clip", .limit_s = 1e-9});
  ck_assert_int_eq(stress.count, 1);
  ck_assert_int_eq(stress.rows[0].outcome, APP_STRESS_LIMIT);
  ck_assert_ptr_nonnull(strstr(stress.rows[0].remark, "did not end within"));
  ck_assert_ptr_nonnull(stress.rows[0].counter);
  ck_assert_int_le(stress.rows[0].steps, 10);
  app_stress_destroy(&stress);
}
END_TEST

// Each class proves of its members what its name says; pairs of another class are not it.
START_TEST(every_class_of_pairs_is_what_its_name_says) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 100; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      ck_assert_msg(app_stress_traits_hold(c, &pair), "%s, member %d", datagen_hard_classes[c].name, member);
      if (strcmp(datagen_hard_classes[c].name, "vertex on face") == 0)
        ck_assert(!app_stress_traits_hold(c + 1, &pair));
    }
}
END_TEST

// Two long lines that cross at a distance wind by half a turn; passing through each other changes that by
// one.
START_TEST(linking_jumps_by_a_turn_where_lines_pass) {
  const double along[6] = {-1e4, 0, 0, 1e4, 0, 0}, above[9] = {0, -1e4, 1, 0, 0, 1, 0, 1e4, 1},
               below[9] = {0, -1e4, -1, 0, 0, -1, 0, 1e4, -1}, parallel[6] = {-1e4, 1, 0, 1e4, 1, 0};
  ck_assert_double_eq_tol(fabs(app_stress_linking(along, 2, above, 3)), 0.5, 1e-3);
  ck_assert_double_eq_tol(app_stress_linking(along, 2, above, 3), -app_stress_linking(along, 2, below, 3),
                          1e-12);
  ck_assert_double_eq_tol(app_stress_linking(along, 2, above, 3), app_stress_linking(above, 3, along, 2),
                          1e-12);
  ck_assert_double_eq_tol(app_stress_linking(along, 2, parallel, 2), 0, 1e-12);
}
END_TEST

START_TEST(every_measure_is_in_the_record) {
  AppStress stress;
  run(&stress, &(AppStressOptions){.has_pairs = true, .is_quick = true, .only = "inside", .models = "clip"});
  Record *record = record_new();
  ck_assert_ok(app_stress_record(&stress, record));
  const Record *rows = record_find(record, "rows");
  ck_assert_int_eq(record_count(rows), stress.count);
  const Record *first = record_at(rows, 0);
  ck_assert_str_eq(record_find_text(first, "case"), "inside");
  ck_assert_int_eq(record_count(record_find(first, "measures")), stress.rows[0].measure_count);
  record_destroy(record);
  app_stress_destroy(&stress);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("stress");
  tcase_add_test(cases, every_class_of_pairs_holds_with_every_model);
  tcase_add_test(cases, the_pairs_of_a_weights_file_are_measured_under_its_name);
  tcase_add_test(cases, the_quick_scenes_hold);
  tcase_add_test(cases, a_name_picks_cases_and_an_unknown_one_is_an_error);
  tcase_add_test(cases, a_verdict_follows_from_the_measures);
  tcase_add_test(cases, a_run_that_was_cut_is_a_limit_but_still_judged_by_what_it_did);
  tcase_add_test(cases, a_limit_of_work_cuts_a_scene_and_says_how_far_it_came);
  tcase_add_test(cases, every_class_of_pairs_is_what_its_name_says);
  tcase_add_test(cases, linking_jumps_by_a_turn_where_lines_pass);
  tcase_add_test(cases, every_measure_is_in_the_record);
  return suite_run("stress", cases, 600);
}
