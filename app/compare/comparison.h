// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of one scene that differ in the overlap model, compared with a reference. What is compared are
// trajectories and contact forces over time, and the audit, which evaluates the models in the same
// configurations of the reference's run.
#ifndef TETLAP_APP_COMPARE_COMPARISON_H
#define TETLAP_APP_COMPARE_COMPARISON_H

#include "app/job/job.h"

// The errors that an audit measures, as in ContactAudit.
typedef enum AppAuditKind {
  APP_AUDIT_VOLUME,
  APP_AUDIT_GRADIENT,
  APP_AUDIT_FORCE, // nodal
  APP_AUDIT_TOTAL, // of interfaces
  APP_AUDIT_KIND_COUNT
} AppAuditKind;

// One audited state.
typedef struct AppAuditRow {
  double time; // [s]
  ContactAuditTerm terms[APP_AUDIT_KIND_COUNT];
} AppAuditRow;

// Those of a model, in the order of time. Zeroed: none.
typedef struct AppAudit {
  int count;
  AppAuditRow *rows; // (count), owned
  size_t capacity;
} AppAudit;

// Fewer states than these say little.
enum { APP_AUDIT_FEW = 10 };

// Relative errors over all audited states; NaN: there are none. INFINITY: the reference is 0 there.
typedef struct AppAuditFigure {
  double error;             // of the sums: Σ differences / Σ sizes, so states weigh by their size
  double median;            // of the states' relative errors
  double worst, worst_time; // the largest of them, and when [s]
} AppAuditFigure;

// Nothing is added for a state in which no two elements overlap. STATUS_MEMORY.
Status app_audit_add(AppAudit *audit, double time, const ContactAudit *state);
Status app_audit_figure(const AppAudit *audit, AppAuditKind kind, AppAuditFigure *figure);

typedef struct AppComparisonModel {
  const char *source; // what the command line says, borrowed
  AppModelName name;  // what it is called (app/cli/model_names.h); its run's folder below the comparison's
  bool is_driven;     // has a run of its own; else audit only
  bool has_run;
  Status status;        // of its run
  long long step_count; // likewise
  char message[512];    // why it failed
  OverlapModel overlap; // for the audit
  FemRunResult result;
  AppAudit audit;
  AppAuditFigure figures[APP_AUDIT_KIND_COUNT]; // of the audit, by app_comparison_conclude
} AppComparisonModel;

enum { APP_MAX_MODELS = 16 };

typedef struct AppComparison {
  AppComparisonModel models[APP_MAX_MODELS];
  int model_count;
  int reference;   // its index; it is driven
  int audit_every; // every k-th accepted step with overlapping elements; 0: never
  bool asks_model; // bodies can meet each other or themselves, not only obstacles without elements
  double length;   // the scene's, for relative trajectories [m]
  double end;      // of the scene [s]
} AppComparison;

// Frames that both have reached: errors are over these.
int app_comparison_common_frames(const FemRunResult *a, const FemRunResult *b);

// ‖f − f_ref‖₂ / ‖f_ref‖₂ over frames and interfaces, and the largest difference over the largest force. NaN
// where the reference has no force in these frames.
typedef struct AppForceError {
  double l2, max;
} AppForceError;
AppForceError app_comparison_force_error(const FemRunResult *result, const FemRunResult *reference);
// Of one interface.
AppForceError app_comparison_interface_error(const FemRunResult *result, const FemRunResult *reference,
                                             int interface);

// Root mean square over frames and vertices of |x − x_ref| [m]; NaN: no frames.
double app_comparison_trajectory_error(const FemRunResult *result, const FemRunResult *reference);

// An observer's part: every audit_every-th step with overlapping elements, all models against the reference
// in this state. `step_in_contact` counts them.
Status app_comparison_audit(AppComparison *comparison, const FemRunProgress *progress,
                            long long *step_in_contact);

// After all runs: fills what the audits come to. STATUS_MEMORY.
Status app_comparison_conclude(AppComparison *comparison);

// One object a model. `list` is the top of compare.json.
void app_comparison_record(const AppComparison *comparison, const char *scene_path, RecordList *list);
// A line a model under one line of names. STATUS_MEMORY, as of the tables.
Status app_comparison_print_csv(const AppComparison *comparison, FILE *stream);
// The tables for a terminal: of the audit, and of the models' own runs.
Status app_comparison_print_table(const AppComparison *comparison, FILE *stream);

void app_comparison_destroy(AppComparison *comparison);

#endif
