// SPDX-License-Identifier: GPL-3.0-or-later
// What the tasks of a verdict have found, as numbers. NaN: not measured.
#ifndef TETLAP_APP_VERDICT_FINDINGS_H
#define TETLAP_APP_VERDICT_FINDINGS_H

#include "app/verdict/tasks.h"
#include "base/files/record.h"

// A scene's run with the model beside that with `clip`.
typedef struct AppVerdictRun {
  const char *scene, *kind;
  char outcome[32];                 // of the run; "": not run
  double share_reached;             // of the scene's time
  double nodal_error;               // of nodal forces in the same states, √Σ|Δf|² / √Σ|f|² (audit)
  double total_error;               // of total forces between bodies, likewise
  double force_error;               // of these forces over time, each along its own path
  double path_error;                // largest distance of the two paths, over the scene's size
  double energy_gain, momentum_gap; // as summary.json; the gap is NaN in static scenes
  double steps, time;               // over those of `clip`: numbers of steps, processor times
} AppVerdictRun;

typedef struct AppVerdictFindings {
  // contract: the worst of all classes of hard pairs
  double balance, order, motion, bounds, gradient, missed;
  long long refused; // classes of pairs that could not be asked
  double volume_jump, gradient_jump;
  // pairs
  double paper_status, paper_volume;                        // share right; mean |ΔV|
  double status_overlapping, status_apart, volume, moments; // of scenes: shares right; ΣΔV/ΣV, Σ|Δm|/Σ|m|
  double pair_gradient;
  // unseen bodies: the worst of all
  double unseen_nodal, unseen_total, unseen_friction, unseen_work;
  AppVerdictRun runs[APP_VERDICT_SCENES];
  int run_count;
} AppVerdictFindings;

// Reads what is there of a plan's tasks. STATUS_INPUT: a file is none of ours.
Status app_verdict_findings_read(const AppVerdictPlan *plan, AppVerdictFindings *findings);

// All numbers, for verdict.json.
void app_verdict_findings_record(const AppVerdictFindings *findings, Record *record);

#endif
