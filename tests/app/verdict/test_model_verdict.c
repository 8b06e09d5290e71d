// SPDX-License-Identifier: GPL-3.0-or-later
// Grades at the edges of their conditions, and what a verdict asks for.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/verdict/grade.h"
#include "base/memory.h"
#include "suite.h"

// Just fit for everything: each figure at its bound.
static AppVerdictFindings at_the_bounds(void) {
  AppVerdictFindings findings = {.motion = 1e-3,
                                 .paper_status = .99,
                                 .status_overlapping = .99,
                                 .status_apart = .99,
                                 .unseen_nodal = .01,
                                 .unseen_total = .01,
                                 .unseen_friction = .005,
                                 .unseen_work = 1e-3,
                                 .run_count = 2};
  findings.runs[0] = (AppVerdictRun){.scene = "press",
                                     .outcome = "finished",
                                     .share_reached = 1,
                                     .nodal_error = .01,
                                     .total_error = .01,
                                     .path_error = .01,
                                     .energy_gain = 1e-3,
                                     .momentum_gap = NAN, // static
                                     .steps = 1.5};
  findings.runs[1] = findings.runs[0];
  findings.runs[1].scene = "drop";
  findings.runs[1].momentum_gap = 1e-3;
  return findings;
}

static void expect(const AppVerdictFindings *findings, bool detect, bool forces, bool motion,
                   const char *reason) {
  AppVerdictGrade grades[APP_VERDICT_USES];
  const bool wanted[] = {detect, forces, motion};
  bool is_told = !reason;
  app_verdict_grade(findings, grades);
  for (int u = 0; u < APP_VERDICT_USES; u++) {
    ck_assert_msg(grades[u].is_fit == wanted[u], "%s: %s", app_verdict_uses[u], grades[u].reason);
    ck_assert_int_eq(grades[u].is_fit, grades[u].reason[0] == 0);
    is_told = is_told || strstr(grades[u].reason, reason);
  }
  ck_assert_msg(is_told, "no grade says '%s'", reason);
}

START_TEST(a_model_at_every_bound_is_fit) {
  AppVerdictFindings findings = at_the_bounds();
  expect(&findings, true, true, true, NULL);
}
END_TEST

START_TEST(one_figure_beyond_its_bound_is_named) {
  AppVerdictFindings findings = at_the_bounds();
  findings.status_apart = .989;
  expect(&findings, false, true, true, "0.989 of disjoint pairs");
  findings = at_the_bounds(), findings.unseen_friction = .0051;
  expect(&findings, true, false, true, "0.0051 false friction");
  findings = at_the_bounds(), findings.runs[1].total_error = .0101;
  expect(&findings, true, false, true, "drop: 0.0101 error of total forces, at most 0.01 is asked");
  findings = at_the_bounds(), findings.unseen_work = .00101;
  expect(&findings, true, true, false, "0.00101 work round a closed path");
  findings = at_the_bounds(), findings.runs[1].momentum_gap = .0011;
  expect(&findings, true, true, false, "drop: 0.0011 of the impulses missing");
  findings = at_the_bounds(), findings.runs[0].steps = 1.6;
  expect(&findings, true, true, false, "press: 1.6 steps over those of clip");
}
END_TEST

START_TEST(a_run_that_did_not_finish_drives_no_motion) {
  AppVerdictFindings findings = at_the_bounds();
  snprintf(findings.runs[1].outcome, sizeof findings.runs[1].outcome, "passed through");
  expect(&findings, true, true, false, "drop: passed through");
}
END_TEST

START_TEST(what_was_not_measured_is_not_met) {
  AppVerdictFindings findings = at_the_bounds();
  findings.unseen_nodal = NAN;
  expect(&findings, true, false, true, "nan error of nodal forces");
  findings = at_the_bounds(), findings.runs[0].nodal_error = NAN;
  expect(&findings, true, false, true, "press: nan");
  findings = at_the_bounds(), findings.run_count = 0;
  expect(&findings, true, false, false, "no run of a scene is there");
}
END_TEST

// The row of a use's conditions that begins so; NULL: there is none.
static const Record *row_of(const Record *root, const char *what) {
  const Record *rows = record_find(root, "rows");
  for (int r = 0; r < record_count(rows); r++)
    if (strstr(record_find_text(record_at(rows, r), "what"), what) != NULL) return record_at(rows, r);
  return NULL;
}

static Record *conditions_of(const AppVerdictFindings *findings, AppVerdictUse use) {
  Record *root = record_new();
  app_verdict_grade_record(findings, use, record_list(root, "rows"));
  return root;
}

static bool is_told_met(const Record *row) {
  char *text = record_text_of(row);
  const bool is_met = strstr(text, "\"met\": true") != NULL;
  ck_assert_msg(is_met != (strstr(text, "\"met\": false") != NULL), "%s", text);
  memory_free(text);
  return is_met;
}

static void expect_row(const Record *root, const char *what, double value, bool is_met, const char *scene) {
  const Record *row = row_of(root, what);
  ck_assert_msg(row != NULL, "%s", what);
  const double found = record_find_number(row, "value");
  const char *where = record_find_text(row, "scene");
  ck_assert_msg(found == value || (isnan(found) && isnan(value)), "%s: %g", what, found);
  ck_assert_msg(is_told_met(row) == is_met, "%s", what);
  ck_assert_msg(scene ? where && strcmp(where, scene) == 0 : !where, "%s: %s", what, where ? where : "");
}

START_TEST(conditions_are_told_with_the_worst_scene) {
  AppVerdictFindings findings = at_the_bounds();
  findings.runs[0].share_reached = .5, findings.runs[0].nodal_error = NAN;
  findings.runs[1].steps = 4;
  snprintf(findings.runs[0].outcome, sizeof findings.runs[0].outcome, "failed");
  Record *detect = conditions_of(&findings, APP_VERDICT_DETECT);
  Record *forces = conditions_of(&findings, APP_VERDICT_FORCES);
  Record *motion = conditions_of(&findings, APP_VERDICT_MOTION);
  ck_assert_int_eq(record_count(record_find(detect, "rows")), 3);
  expect_row(detect, "of disjoint pairs", .99, true, NULL);
  expect_row(forces, "error of nodal forces on unseen", .01, true, NULL);
  expect_row(forces, "error of total forces on unseen", .01, true, NULL);
  ck_assert_int_eq(record_count(record_find(forces, "rows")), 6);
  const Record *last = record_at(record_find(forces, "rows"), 4);
  ck_assert_str_eq(record_find_text(last, "scene"), "press"); // not measured is worst
  ck_assert(!is_told_met(last));
  expect_row(motion, "of the time reached", .5, false, "press");
  expect_row(motion, "steps over", 4, false, "drop");
  expect_row(motion, "of the impulses missing", 1e-3, true, "drop"); // the other scene is static
  expect_row(motion, "of the scenes' runs finished", .5, false, NULL);
  record_destroy(detect), record_destroy(forces), record_destroy(motion);
  findings.run_count = 0;
  motion = conditions_of(&findings, APP_VERDICT_MOTION);
  expect_row(motion, "of the scenes' runs finished", NAN, false, NULL);
  ck_assert_ptr_null(row_of(motion, "steps over"));
  record_destroy(motion);
}
END_TEST

START_TEST(quick_leaves_half_of_the_scenes_out) {
  AppVerdictPlan plan = {.directory = "out", .source = "clip", .name = "clip", .seed = 7, .threads = 1};
  AppVerdictTask task;
  bool is_wanted;
  int counts[2] = {0, 0};
  for (int quick = 0; quick < 2; quick++)
    for (int t = 0; t < APP_VERDICT_TASKS; t++) {
      plan.is_quick = quick;
      ck_assert_int_eq(app_verdict_task(&plan, t, &task, &is_wanted), STATUS_OK);
      counts[quick] += is_wanted;
      if (is_wanted) ck_assert_str_eq(task.words[0], "tetlap");
    }
  ck_assert_int_eq(counts[0], 5 + APP_VERDICT_SCENES);
  ck_assert_int_eq(counts[1], 5 + 5);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("model_verdict");
  tcase_add_test(cases, a_model_at_every_bound_is_fit);
  tcase_add_test(cases, one_figure_beyond_its_bound_is_named);
  tcase_add_test(cases, a_run_that_did_not_finish_drives_no_motion);
  tcase_add_test(cases, what_was_not_measured_is_not_met);
  tcase_add_test(cases, conditions_are_told_with_the_worst_scene);
  tcase_add_test(cases, quick_leaves_half_of_the_scenes_out);
  return suite_run("model_verdict", cases, 60);
}
