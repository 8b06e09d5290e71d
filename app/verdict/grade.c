// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/grade.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

const char *const app_verdict_uses[APP_VERDICT_USES] = {"detect", "forces", "motion"};

// A figure of the findings and its bound.
typedef struct Condition {
  AppVerdictUse use;
  const char *words;
  size_t offset;
  double bound;
  bool is_least;
} Condition;

#define OF(member) offsetof(AppVerdictFindings, member)

static const Condition conditions[] = {
    {APP_VERDICT_DETECT, "of overlapping pairs of scenes found", OF(status_overlapping), .99, true},
    {APP_VERDICT_DETECT, "of disjoint pairs whose boxes overlap found disjoint", OF(status_apart), .99, true},
    {APP_VERDICT_DETECT, "of the paper's pairs right, mean of the kinds", OF(paper_status), .99, true},
    {APP_VERDICT_FORCES, "error of nodal forces on unseen bodies", OF(unseen_nodal), .01, false},
    {APP_VERDICT_FORCES, "error of total forces on unseen bodies", OF(unseen_total), .01, false},
    {APP_VERDICT_FORCES, "false friction on unseen bodies", OF(unseen_friction), .005, false},
    {APP_VERDICT_FORCES, "change under rotation and translation", OF(motion), 1e-3, false},
    {APP_VERDICT_MOTION, "work round a closed path", OF(unseen_work), 1e-3, false},
};

#define IN(member) offsetof(AppVerdictRun, member)

// The same of every run.
static const Condition run_conditions[] = {
    {APP_VERDICT_FORCES, "error of nodal forces", IN(nodal_error), .01, false},
    {APP_VERDICT_FORCES, "error of total forces", IN(total_error), .01, false},
    {APP_VERDICT_MOTION, "of the time reached", IN(share_reached), 1, true},
    {APP_VERDICT_MOTION, "of the energy gained", IN(energy_gain), 1e-3, false},
    {APP_VERDICT_MOTION, "steps over those of clip", IN(steps), 1.5, false},
    {APP_VERDICT_MOTION, "off the path of clip, over the scene's size", IN(path_error), .01, false},
};

static const Condition gap_condition = {APP_VERDICT_MOTION, "of the impulses missing", IN(momentum_gap), 1e-3,
                                        false}; // none in statics
static const Condition end_condition = {APP_VERDICT_MOTION, "of the scenes' runs finished", 0, 1, true};

static double figure(const void *from, size_t offset) {
  double value;
  memcpy(&value, (const char *)from + offset, sizeof value);
  return value;
}

static bool is_met(const Condition *condition, double value) {
  return condition->is_least ? value >= condition->bound : value <= condition->bound;
}

static void refuse(AppVerdictGrade *grade, const Condition *condition, double value, const char *scene) {
  if (!grade->is_fit) return;
  grade->is_fit = false;
  snprintf(grade->reason, sizeof grade->reason, "%s%s%.3g %s, %s %.3g is asked", scene ? scene : "",
           scene ? ": " : "", value, condition->words, condition->is_least ? "at least" : "at most",
           condition->bound);
}

static void judge_runs(const AppVerdictFindings *findings, AppVerdictGrade *grades) {
  for (int r = 0; r < findings->run_count; r++) {
    const AppVerdictRun *run = &findings->runs[r];
    for (size_t c = 0; c < sizeof run_conditions / sizeof *run_conditions; c++) {
      double value = figure(run, run_conditions[c].offset);
      if (!is_met(&run_conditions[c], value))
        refuse(&grades[run_conditions[c].use], &run_conditions[c], value, run->scene);
    }
    AppVerdictGrade *motion = &grades[APP_VERDICT_MOTION];
    if (run->momentum_gap > gap_condition.bound)
      refuse(motion, &gap_condition, run->momentum_gap, run->scene);
    if (motion->is_fit && strcmp(run->outcome, "finished") != 0) {
      motion->is_fit = false;
      snprintf(motion->reason, sizeof motion->reason, "%s: %s", run->scene, run->outcome);
    }
  }
}

void app_verdict_grade(const AppVerdictFindings *findings, AppVerdictGrade grades[APP_VERDICT_USES]) {
  for (int u = 0; u < APP_VERDICT_USES; u++) grades[u] = (AppVerdictGrade){.is_fit = true};
  for (size_t c = 0; c < sizeof conditions / sizeof *conditions; c++) {
    double value = figure(findings, conditions[c].offset);
    if (!is_met(&conditions[c], value)) refuse(&grades[conditions[c].use], &conditions[c], value, NULL);
  }
  judge_runs(findings, grades);
  for (int u = APP_VERDICT_FORCES; u < APP_VERDICT_USES; u++)
    if (grades[u].is_fit && findings->run_count == 0) {
      grades[u].is_fit = false;
      snprintf(grades[u].reason, sizeof grades[u].reason, "no run of a scene is there");
    }
}

static void record_condition(RecordList *rows, const Condition *condition, double value, const char *scene) {
  Record *row = record_append(rows);
  record_text(row, "what", condition->words);
  record_number(row, "bound", condition->bound);
  record_bool(row, "least", condition->is_least);
  record_number(row, "value", value);
  if (scene) record_text(row, "scene", scene);
  record_bool(row, "met", is_met(condition, value));
}

// Of all runs; what was not measured is worst. Runs without a gap of momenta have no part in that condition.
static void record_worst(const AppVerdictFindings *findings, const Condition *condition, RecordList *rows) {
  const AppVerdictRun *worst = NULL;
  double most = 0;
  for (int r = 0; r < findings->run_count; r++) {
    const double value = figure(&findings->runs[r], condition->offset);
    if (isnan(value) && condition == &gap_condition) continue;
    if (worst && (isnan(most) || (condition->is_least ? value >= most : value <= most))) continue;
    worst = &findings->runs[r], most = value;
  }
  if (worst) record_condition(rows, condition, most, worst->scene);
}

static void record_ends(const AppVerdictFindings *findings, RecordList *rows) {
  int finished = 0;
  for (int r = 0; r < findings->run_count; r++)
    finished += strcmp(findings->runs[r].outcome, "finished") == 0;
  record_condition(rows, &end_condition, finished / (double)findings->run_count, NULL); // no run: NaN
}

void app_verdict_grade_record(const AppVerdictFindings *findings, AppVerdictUse use, RecordList *rows) {
  for (size_t c = 0; c < sizeof conditions / sizeof *conditions; c++)
    if (conditions[c].use == use)
      record_condition(rows, &conditions[c], figure(findings, conditions[c].offset), NULL);
  for (size_t c = 0; c < sizeof run_conditions / sizeof *run_conditions; c++)
    if (run_conditions[c].use == use) record_worst(findings, &run_conditions[c], rows);
  if (use != APP_VERDICT_MOTION) return;
  record_worst(findings, &gap_condition, rows);
  record_ends(findings, rows);
}
