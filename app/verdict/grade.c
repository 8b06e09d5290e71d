// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/grade.h"

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
    static const Condition gap = {APP_VERDICT_MOTION, "of the impulses missing", IN(momentum_gap), 1e-3,
                                  false};
    AppVerdictGrade *motion = &grades[APP_VERDICT_MOTION];
    if (run->momentum_gap > gap.bound) refuse(motion, &gap, run->momentum_gap, run->scene); // none in statics
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
