// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases, checked against physics: every class of pairs and every scene with every overlap model. A row
// is a case with a model. It asserts that the case did occur and what must hold; what was measured is kept,
// and the verdict follows from it:
//
//   all met ───────────────────────────────► held      (better: though app/stress/limits.c knows a limit)
//   not met, within the model's tolerance ──► tolerance (pairs only, app/stress/pairs/tolerances.c)
//   not met, a limit that is known ─────────► limit     (its reason and counter, app/stress/limits.c)
//   cut: the processor time it was given is spent ► limit (what held until then is judged all the same)
//   not met otherwise ──────────────────────► failed
//   could not be asked, with a reason ──────► absent    (weights missing, too slow)
#ifndef TETLAP_APP_STRESS_STRESS_H
#define TETLAP_APP_STRESS_STRESS_H

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>

#include "app/cli/model_names.h"
#include "base/files/record.h"
#include "base/status.h"

enum { APP_STRESS_MAX_MEASURES = 12, APP_STRESS_MAX_MODELS = 64 };

typedef enum AppStressOutcome {
  APP_STRESS_HELD,
  APP_STRESS_BETTER,
  APP_STRESS_TOLERANCE,
  APP_STRESS_LIMIT,
  APP_STRESS_ABSENT,
  APP_STRESS_FAILED,
} AppStressOutcome;
enum { APP_STRESS_OUTCOME_COUNT = 6 };

typedef struct AppStressMeasure {
  const char *name; // static
  double value, bound;
  bool is_least;      // value ≥ bound is asked, else value ≤ bound
  bool is_occurrence; // says that the case did occur
  bool is_of_end;     // makes sense only of a run that came to its end
  bool is_met;
} AppStressMeasure;

typedef struct AppStressRow {
  const char *group; // "pairs" or "scenes"
  const char *name, *model;
  AppStressOutcome outcome;
  AppStressMeasure measures[APP_STRESS_MAX_MEASURES];
  int measure_count;
  char remark[400];    // reason of a limit, an absence; a run's message
  const char *counter; // that makes a limit visible; NULL: none
  bool is_cut;         // ran out of its processor time: what needs its end cannot be asked
  double cpu_s;
  long long steps;     // of a scene: accepted
  long long pairs;     // that the overlap model was asked; of a class: its members
  long long fallbacks; // of a class: members that the model left to another (OVERLAP_FALLBACK)
} AppStressRow;

typedef struct AppStress {
  AppStressRow *rows;  // owned
  AppModelName *names; // of the models that are weights files, owned
  int count;
  size_t capacity;
} AppStress;

typedef struct AppStressOptions {
  bool has_pairs, has_scenes, is_quick;
  const char *only; // part of a case's name; NULL: all
  // Comma-separated; NULL: all, with `is_quick` clip, geo and any. Weights files only without scenes.
  const char *models;
  double limit_s; // processor time of a scene with a model; 0: the case's own
  const volatile sig_atomic_t *stop;
  void (*observe)(void *observer, const AppStress *stress); // after each row, the last; may be NULL
  void *observer;
} AppStressOptions;

// Whether a case of that name, and a model, are asked for.
bool app_stress_wants(const AppStressOptions *options, const char *name);
bool app_stress_wants_model(const AppStressOptions *options, const char *model);

void app_stress_destroy(AppStress *stress);

// A new row at the end; NULL: no memory.
AppStressRow *app_stress_add(AppStress *stress, const char *group, const char *name, const char *model);
// value ≤ bound; value ≥ bound; that the case did occur; that the run's time was reached. NaN is not met.
void app_stress_ask_most(AppStressRow *row, const char *name, double value, double bound);
void app_stress_ask_least(AppStressRow *row, const char *name, double value, double bound);
void app_stress_ask_occurred(AppStressRow *row, const char *name, double value, double least);
void app_stress_ask_end(AppStressRow *row, double time, double end);
// The verdict, from the measures and the limits that are known.
void app_stress_judge(AppStressRow *row);
// The row says why it could not be asked.
void app_stress_excuse(AppStressRow *row, const char *format, ...) __attribute__((format(printf, 2, 3)));

const char *app_stress_outcome_name(AppStressOutcome outcome);
int app_stress_count(const AppStress *stress, AppStressOutcome outcome);

// A table for people: case × model, then the reasons; and everything as JSON.
void app_stress_print(const AppStress *stress, FILE *stream);
Status app_stress_record(const AppStress *stress, Record *record);

#endif
