// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of one scene that differ in the overlap model, compared with a reference: trajectories and contact
// forces over time, and the audit, which evaluates the models in the same configurations of the reference's
// run.
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

// One audited configuration.
typedef struct AppAuditRow {
  double time; // [s]
  double errors[APP_AUDIT_KIND_COUNT];
} AppAuditRow;

// Of contact_system_audit over the audited configurations. Zeroed: none.
typedef struct AppAuditSums {
  double sum[APP_AUDIT_KIND_COUNT], max[APP_AUDIT_KIND_COUNT];
  int count;
  AppAuditRow *rows; // (count), owned
  size_t capacity;
} AppAuditSums;

typedef struct AppComparisonModel {
  const char *source; // what the command line says, borrowed
  AppModelName name;  // what it is called (app/cli/model_names.h); its run's folder below the comparison's
  bool is_driven;     // has a run of its own; else audit only
  bool has_run;
  Status status;        // of its run
  char message[512];    // why it failed
  OverlapModel overlap; // for the audit
  FemRunResult result;
  AppAuditSums audit;
} AppComparisonModel;

enum { APP_MAX_MODELS = 16 };

typedef struct AppComparison {
  AppComparisonModel models[APP_MAX_MODELS];
  int model_count;
  int reference;   // its index; it is driven
  int audit_every; // every k-th accepted step in contact; 0: never
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

// An observer's part: every audit_every-th step with overlap, all models against the reference in this
// configuration. `step_in_contact` counts them.
Status app_comparison_audit(AppComparison *comparison, const FemRunProgress *progress,
                            long long *step_in_contact);

// One object a model. `list` is the top of compare.json.
void app_comparison_record(const AppComparison *comparison, const char *scene_path, RecordList *list);
// A line a model under one line of names.
void app_comparison_print_csv(const AppComparison *comparison, FILE *stream);
// The table for a terminal.
void app_comparison_print_table(const AppComparison *comparison, FILE *stream);

void app_comparison_destroy(AppComparison *comparison);

#endif
