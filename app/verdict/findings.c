// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/findings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

// The worse of two; what is not measured is passed over.
static double worse(double a, double b) {
  return isnan(a) || b > a ? b : a;
}

// NULL: the task has left none.
static Status read(const AppVerdictPlan *plan, int index, Record **record) {
  AppVerdictTask task;
  bool is_wanted;
  *record = NULL;
  TRY(app_verdict_task(plan, index, &task, &is_wanted));
  if (!is_wanted || !file_exists(task.output)) return STATUS_OK;
  return record_read(record, task.output);
}

static double measure(const Record *row, const char *name) {
  const Record *measures = record_find(row, "measures");
  for (int m = 0; m < record_count(measures); m++) {
    const Record *entry = record_at(measures, m);
    const char *text = record_find_text(entry, "name");
    if (text && strcmp(text, name) == 0) return record_find_number(entry, "value");
  }
  return NAN;
}

// A model that is exact to rounding is asked for that alone, by its misfit in units of the rounding: then
// another order and a motion change nothing beyond it.
static void fill_exact(AppVerdictFindings *findings, double misfit) {
  if (!(misfit <= 1)) return;
  if (isnan(findings->order)) findings->order = 0;
  if (isnan(findings->motion)) findings->motion = 0;
}

static Status read_contract(const AppVerdictPlan *plan, AppVerdictFindings *findings) {
  Record *root;
  double misfit = NAN;
  TRY(read(plan, 0, &root));
  const Record *rows = record_find(root, "rows");
  for (int r = 0; r < record_count(rows); r++) {
    const Record *row = record_at(rows, r);
    const char *outcome = record_find_text(row, "outcome");
    findings->refused += outcome && strcmp(outcome, "absent") == 0;
    misfit = worse(misfit, measure(row, "misfit"));
    findings->balance = worse(findings->balance, measure(row, "balance"));
    findings->order = worse(findings->order, measure(row, "order"));
    findings->motion = worse(findings->motion, measure(row, "motion"));
    findings->bounds = worse(findings->bounds, measure(row, "bounds"));
    findings->gradient = worse(findings->gradient, measure(row, "gradient"));
    findings->missed = worse(findings->missed, measure(row, "missed"));
  }
  fill_exact(findings, misfit);
  record_destroy(root);
  return STATUS_OK;
}

static Status read_paths(const AppVerdictPlan *plan, AppVerdictFindings *findings) {
  Record *root;
  TRY(read(plan, 1, &root));
  const Record *paths = record_find(root, "paths");
  findings->volume_jump = record_find_number(paths, "volume_jump");
  findings->gradient_jump = record_find_number(paths, "gradient_jump");
  record_destroy(root);
  return STATUS_OK;
}

static Status read_pairs(const AppVerdictPlan *plan, AppVerdictFindings *findings) {
  Record *paper, *scene;
  TRY(read(plan, 2, &paper));
  findings->paper_status = record_find_number(paper, "accuracy_mean");
  findings->paper_volume = record_find_number(paper, "mae");
  record_destroy(paper);
  TRY(read(plan, 3, &scene));
  const Record *accuracy = record_find(scene, "accuracy");
  findings->status_overlapping = record_find_number(accuracy, "scene");
  findings->status_apart = record_find_number(accuracy, "scene-none");
  findings->volume = record_find_number(scene, "volume_error_sum");
  findings->moments = record_find_number(scene, "moment_error_own");
  findings->pair_gradient = record_find_number(scene, "gradient_error");
  record_destroy(scene);
  return STATUS_OK;
}

static Status add_unseen(AppVerdictFindings *findings, const char *line, size_t size, const char *name) {
  Record *row;
  TRY(record_parse(&row, line, size, name));
  findings->unseen_nodal = worse(findings->unseen_nodal, record_find_number(row, "nodal_force_error"));
  findings->unseen_total = worse(findings->unseen_total, record_find_number(row, "total_force_error"));
  findings->unseen_friction = worse(findings->unseen_friction, record_find_number(row, "tangential_error"));
  findings->unseen_work = worse(findings->unseen_work, record_find_number(row, "path_work"));
  record_destroy(row);
  return STATUS_OK;
}

static Status read_unseen(const AppVerdictPlan *plan, AppVerdictFindings *findings) {
  AppVerdictTask task;
  bool is_wanted;
  char *text;
  size_t size;
  Status status = STATUS_OK;
  TRY(app_verdict_task(plan, 4, &task, &is_wanted));
  if (!file_exists(task.output)) return STATUS_OK;
  TRY(file_read(task.output, &text, &size));
  for (char *line = text, *end; !status && (end = strchr(line, '\n')); line = end + 1)
    status = add_unseen(findings, line, (size_t)(end - line), task.output);
  memory_free(text);
  return status;
}

static void fill_run(AppVerdictRun *run, const Record *reference, const Record *row) {
  const Record *ours = record_find(row, "summary"), *theirs = record_find(reference, "summary");
  const char *outcome = record_find_text(row, "outcome");
  snprintf(run->outcome, sizeof run->outcome, "%s", outcome ? outcome : "failed");
  run->share_reached = record_find_number(row, "share_reached");
  run->nodal_error = record_find_number(row, "audit_force_error");
  run->total_error = record_find_number(row, "audit_total_force_error");
  run->force_error = record_find_number(row, "force_error_l2");
  run->path_error = record_find_number(row, "trajectory_error");
  run->energy_gain = record_find_number(row, "energy_gain_relative");
  run->momentum_gap = record_find_number(ours, "momentum_gap");
  run->steps = record_find_number(ours, "steps") / record_find_number(theirs, "steps");
  run->time = record_find_number(ours, "cpu_s") / record_find_number(theirs, "cpu_s");
}

static Status read_run(const AppVerdictPlan *plan, int scene, AppVerdictFindings *findings) {
  Record *rows;
  TRY(read(plan, 5 + scene, &rows));
  if (!rows) return STATUS_OK;
  AppVerdictRun *run = &findings->runs[findings->run_count++];
  run->scene = app_verdict_scenes[scene].name, run->kind = app_verdict_scenes[scene].kind;
  const Record *last = record_at(rows, record_count(rows) - 1);
  fill_run(run, record_at(rows, 0), last);
  record_destroy(rows);
  return STATUS_OK;
}

Status app_verdict_findings_read(const AppVerdictPlan *plan, AppVerdictFindings *findings) {
  *findings = (AppVerdictFindings){.balance = NAN,
                                   .order = NAN,
                                   .motion = NAN,
                                   .bounds = NAN,
                                   .gradient = NAN,
                                   .missed = NAN,
                                   .unseen_nodal = NAN,
                                   .unseen_total = NAN,
                                   .unseen_friction = NAN,
                                   .unseen_work = NAN};
  TRY(read_contract(plan, findings));
  TRY(read_paths(plan, findings));
  TRY(read_pairs(plan, findings));
  TRY(read_unseen(plan, findings));
  for (int s = 0; s < APP_VERDICT_SCENES; s++) TRY(read_run(plan, s, findings));
  return STATUS_OK;
}

static void record_run(const AppVerdictRun *run, Record *row) {
  record_text(row, "scene", run->scene);
  record_text(row, "kind", run->kind);
  record_text(row, "outcome", run->outcome);
  record_number(row, "share_reached", run->share_reached);
  record_number(row, "nodal_force_error", run->nodal_error);
  record_number(row, "total_force_error", run->total_error);
  record_number(row, "run_force_error", run->force_error);
  record_number(row, "path_error", run->path_error);
  record_number(row, "energy_gain", run->energy_gain);
  record_number(row, "momentum_gap", run->momentum_gap);
  record_number(row, "steps_ratio", run->steps);
  record_number(row, "time_ratio", run->time);
}

void app_verdict_findings_record(const AppVerdictFindings *findings, Record *record) {
  Record *contract = record_child(record, "contract"), *pairs = record_child(record, "pairs"),
         *unseen = record_child(record, "unseen");
  record_number(contract, "balance", findings->balance);
  record_number(contract, "order", findings->order);
  record_number(contract, "motion", findings->motion);
  record_number(contract, "bounds", findings->bounds);
  record_number(contract, "gradient", findings->gradient);
  record_number(contract, "missed", findings->missed);
  record_integer(contract, "refused", findings->refused);
  record_number(contract, "volume_jump", findings->volume_jump);
  record_number(contract, "gradient_jump", findings->gradient_jump);
  record_number(pairs, "paper_status", findings->paper_status);
  record_number(pairs, "paper_mae", findings->paper_volume);
  record_number(pairs, "status_overlapping", findings->status_overlapping);
  record_number(pairs, "status_apart", findings->status_apart);
  record_number(pairs, "volume_error", findings->volume);
  record_number(pairs, "moment_error", findings->moments);
  record_number(pairs, "gradient_error", findings->pair_gradient);
  record_number(unseen, "nodal_force_error", findings->unseen_nodal);
  record_number(unseen, "total_force_error", findings->unseen_total);
  record_number(unseen, "false_friction", findings->unseen_friction);
  record_number(unseen, "path_work", findings->unseen_work);
  RecordList *runs = record_list(record, "runs");
  for (int r = 0; r < findings->run_count; r++) record_run(&findings->runs[r], record_append(runs));
}
