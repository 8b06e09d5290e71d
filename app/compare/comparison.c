// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/comparison.h"

#include <math.h>
#include <string.h>

#include "app/cli/format.h"
#include "app/table/table.h"
#include "base/memory.h"
#include "base/sorted.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"

int app_comparison_common_frames(const FemRunResult *a, const FemRunResult *b) {
  return a->trajectory.frame_count < b->trajectory.frame_count ? a->trajectory.frame_count
                                                               : b->trajectory.frame_count;
}

// Over the interfaces from `first` to before `last`.
static AppForceError force_error(const FemRunResult *result, const FemRunResult *reference, int first,
                                 int last) {
  double difference = 0, size = 0, largest_difference = 0, largest = 0;
  for (int f = 0; f < app_comparison_common_frames(result, reference); f++)
    for (int i = first; i < last; i++) {
      size_t at = 3 * ((size_t)f * (size_t)reference->trajectory.interface_count + (size_t)i);
      Vec3 force = vec3_at(reference->trajectory.interface_forces + at);
      Vec3 change = vec3_sub(vec3_at(result->trajectory.interface_forces + at), force);
      difference += vec3_dot(change, change);
      size += vec3_dot(force, force);
      largest_difference = fmax(largest_difference, vec3_length(change));
      largest = fmax(largest, vec3_length(force));
    }
  if (!(size > 0)) return (AppForceError){NAN, NAN};
  return (AppForceError){sqrt(difference / size), largest_difference / largest};
}

AppForceError app_comparison_force_error(const FemRunResult *result, const FemRunResult *reference) {
  return force_error(result, reference, 0, reference->trajectory.interface_count);
}

AppForceError app_comparison_interface_error(const FemRunResult *result, const FemRunResult *reference,
                                             int interface) {
  return force_error(result, reference, interface, interface + 1);
}

double app_comparison_trajectory_error(const FemRunResult *result, const FemRunResult *reference) {
  int frames = app_comparison_common_frames(result, reference);
  size_t count = (size_t)frames * (size_t)reference->trajectory.vertex_count;
  double sum = 0;
  for (size_t i = 0; i < 3 * count; i++) {
    double change = result->trajectory.positions[i] - reference->trajectory.positions[i];
    sum += change * change;
  }
  return count > 0 ? sqrt(sum / (double)count) : NAN;
}

Status app_audit_add(AppAudit *audit, double time, const ContactAudit *state) {
  if (state->pair_count == 0) return STATUS_OK;
  size_t count = (size_t)audit->count + 1;
  if (!memory_reserve((void **)&audit->rows, &audit->capacity, count, sizeof *audit->rows))
    return status_no_memory("the audits");
  audit->rows[audit->count++] =
      (AppAuditRow){.time = time, .terms = {state->volume, state->gradient, state->force, state->total}};
  return STATUS_OK;
}

Status app_audit_figure(const AppAudit *audit, AppAuditKind kind, AppAuditFigure *figure) {
  *figure = (AppAuditFigure){NAN, NAN, NAN, NAN};
  if (audit->count == 0) return STATUS_OK;
  double *errors = memory_zeroed((size_t)audit->count, sizeof *errors);
  if (!errors) return status_no_memory("the audits");
  ContactAuditTerm sum = {0};
  for (int i = 0; i < audit->count; i++) {
    ContactAuditTerm term = audit->rows[i].terms[kind];
    sum.difference += term.difference, sum.size += term.size;
    errors[i] = contact_audit_error(term);
    if (errors[i] <= figure->worst) continue;
    figure->worst = errors[i], figure->worst_time = audit->rows[i].time;
  }
  figure->error = contact_audit_error(sum);
  sorted_values(errors, (size_t)audit->count);
  figure->median = sorted_median(errors, (size_t)audit->count);
  memory_free(errors);
  return STATUS_OK;
}

Status app_comparison_conclude(AppComparison *comparison) {
  for (int m = 0; m < comparison->model_count; m++) {
    AppComparisonModel *model = &comparison->models[m];
    for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++)
      TRY(app_audit_figure(&model->audit, (AppAuditKind)k, &model->figures[k]));
  }
  return STATUS_OK;
}

// All models but the reference have the same states.
static int audited_states(const AppComparison *comparison) {
  int count = 0;
  for (int m = 0; m < comparison->model_count; m++)
    if (comparison->models[m].audit.count > count) count = comparison->models[m].audit.count;
  return count;
}

// Why there is no audit, or that it is of few states; empty: neither.
static void tell_audit(const AppComparison *comparison, char *text, size_t size) {
  int states = audited_states(comparison);
  const char *reference = comparison->models[comparison->reference].name;
  *text = 0;
  if (!comparison->asks_model)
    snprintf(text, size, "contact is with obstacles without elements only: its forces use no overlap model");
  else if (comparison->audit_every > 0 && states == 0 && comparison->model_count > 1)
    snprintf(text, size, "no two elements overlapped in a step of the run of %s", reference);
  else if (states > 0 && states < APP_AUDIT_FEW)
    snprintf(text, size, "only %d %s audited, which is few; a smaller --audit than %d audits more", states,
             states == 1 ? "state was" : "states were", comparison->audit_every);
}

Status app_comparison_audit(AppComparison *comparison, const FemRunProgress *progress,
                            long long *step_in_contact) {
  void *effect = fem_system_effect(progress->system, &fem_effect_contact);
  if (!effect) return STATUS_OK;
  ContactSystem *contact = fem_effect_contact_system(effect);
  comparison->asks_model = contact_system_asks_model(contact);
  if (comparison->audit_every == 0) return STATUS_OK;
  const FemState *accepted = &progress->system->accepted;
  const ContactEvaluation *evaluation;
  TRY(fem_effect_contact_evaluate(progress->system, accepted, &evaluation));
  if (evaluation->mesh_pair_count == 0) return STATUS_OK;
  if ((*step_in_contact)++ % comparison->audit_every != 0) return STATUS_OK;
  for (int m = 0; m < comparison->model_count; m++) {
    if (m == comparison->reference) continue;
    ContactAudit state;
    TRY(contact_system_audit(contact, progress->time, accepted->positions, &comparison->models[m].overlap,
                             &comparison->models[comparison->reference].overlap, &state));
    TRY(app_audit_add(&comparison->models[m].audit, progress->time, &state));
  }
  return STATUS_OK;
}

static const char *const audit_words[APP_AUDIT_KIND_COUNT] = {"volume", "gradient", "force", "total_force"};

// What is said of one model, NaN where it does not apply.
typedef struct Row {
  const char *model, *reference, *outcome;
  long long audits;
  AppAuditFigure figures[APP_AUDIT_KIND_COUNT];
  double frames; // that both have reached
  double share;  // of the scene's time that was reached
  AppForceError force;
  double trajectory; // relative to the scene's length
  double energy_gain, wall_s, overlap_s;
} Row;

static Row row_of(const AppComparison *comparison, int m) {
  const AppComparisonModel *model = &comparison->models[m],
                           *reference = &comparison->models[comparison->reference];
  Row row = {.model = model->name,
             .reference = reference->name,
             .outcome = !model->is_driven ? "audit only"
                        : model->status == STATUS_INTERRUPTED
                            ? "cut short"
                            : fem_run_outcome(&model->result, model->status),
             .audits = model->audit.count,
             .frames = NAN,
             .share = NAN,
             .force = {NAN, NAN},
             .trajectory = NAN,
             .energy_gain = NAN,
             .wall_s = NAN,
             .overlap_s = NAN};
  memcpy(row.figures, model->figures, sizeof row.figures);
  if (!model->has_run) return row;
  row.frames = app_comparison_common_frames(&model->result, &reference->result);
  row.share = model->result.end_time / comparison->end;
  row.force = app_comparison_force_error(&model->result, &reference->result);
  row.trajectory = app_comparison_trajectory_error(&model->result, &reference->result) / comparison->length;
  row.energy_gain = model->result.energy.audit.gain / model->result.energy.audit.scale;
  row.wall_s = model->result.cost.wall_s;
  row.overlap_s = model->result.cost.phases.overlap;
  return row;
}

#define AUDITED(kind, part)                                                                                  \
  offsetof(Row, figures) + (kind) * sizeof(AppAuditFigure) + offsetof(AppAuditFigure, part)
#define AUDIT(key, kind)                                                                                     \
  {"audit_" key "_error", APP_TABLE_NUMBER, AUDITED(kind, error), NULL, NULL},                               \
      {"audit_" key "_error_median", APP_TABLE_NUMBER, AUDITED(kind, median), NULL, NULL},                   \
      {"audit_" key "_error_worst", APP_TABLE_NUMBER, AUDITED(kind, worst), NULL, NULL}, {                   \
    "audit_" key "_error_worst_time", APP_TABLE_NUMBER, AUDITED(kind, worst_time), NULL, NULL                \
  }

static const AppTableColumn name_columns[] = {
    {"model", APP_TABLE_TEXT, offsetof(Row, model), "model", NULL},
    {"reference", APP_TABLE_TEXT, offsetof(Row, reference), NULL, NULL},
    {"outcome", APP_TABLE_TEXT, offsetof(Row, outcome), "outcome", NULL},
};
static const AppTableColumn audit_columns[] = {
    {"audits", APP_TABLE_INTEGER, offsetof(Row, audits), NULL, NULL},
    AUDIT("volume", APP_AUDIT_VOLUME),
    AUDIT("gradient", APP_AUDIT_GRADIENT),
    AUDIT("force", APP_AUDIT_FORCE),
    AUDIT("total_force", APP_AUDIT_TOTAL),
};
static const AppTableColumn run_columns[] = {
    {"frames_compared", APP_TABLE_COUNT, offsetof(Row, frames), "frames", NULL},
    {"share_reached", APP_TABLE_NUMBER, offsetof(Row, share), "share of time", NULL},
    {"force_error_l2", APP_TABLE_NUMBER, offsetof(Row, force.l2), "force L2", NULL},
    {"force_error_max", APP_TABLE_NUMBER, offsetof(Row, force.max), "force max", NULL},
    {"trajectory_error", APP_TABLE_NUMBER, offsetof(Row, trajectory), "path RMS/L", NULL},
    {"energy_gain_relative", APP_TABLE_NUMBER, offsetof(Row, energy_gain), "energy gain", NULL},
    {"wall_s", APP_TABLE_NUMBER, offsetof(Row, wall_s), "wall s", NULL},
    {"overlap_s", APP_TABLE_NUMBER, offsetof(Row, overlap_s), "overlap s", NULL},
};
enum {
  NAME_COUNT = sizeof name_columns / sizeof *name_columns,
  AUDIT_COUNT = sizeof audit_columns / sizeof *audit_columns,
  RUN_COUNT = sizeof run_columns / sizeof *run_columns,
};

static void record_interfaces(const AppComparison *comparison, int m, Record *record) {
  const FemRunResult *result = &comparison->models[m].result,
                     *reference = &comparison->models[comparison->reference].result;
  RecordList *list = record_list(record, "interfaces");
  for (int i = 0; i < reference->trajectory.interface_count; i++) {
    AppForceError error = app_comparison_interface_error(result, reference, i);
    Record *one = record_append(list);
    record_text(one, "name", reference->trajectory.interface_names[i]);
    record_number(one, "force_error_l2", error.l2);
    record_number(one, "force_error_max", error.max);
  }
}

// The audited states one by one, for plots over time.
static void record_series(const AppAudit *audit, Record *record) {
  if (audit->count == 0) return;
  Record *series = record_child(record, "audit_series");
  RecordList *times = record_list(series, "time_s"), *forces = record_list(series, "force_N");
  for (int i = 0; i < audit->count; i++) {
    record_append_number(times, audit->rows[i].time);
    record_append_number(forces, audit->rows[i].terms[APP_AUDIT_FORCE].size);
  }
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    RecordList *errors = record_list(series, audit_words[k]);
    for (int i = 0; i < audit->count; i++)
      record_append_number(errors, contact_audit_error(audit->rows[i].terms[k]));
  }
}

void app_comparison_record(const AppComparison *comparison, const char *scene_path, RecordList *list) {
  char told[512];
  tell_audit(comparison, told, sizeof told);
  for (int m = 0; m < comparison->model_count; m++) {
    const AppComparisonModel *model = &comparison->models[m];
    Row row = row_of(comparison, m);
    Record *record = record_append(list);
    char path[PATH_MAX];
    app_format_record(record);
    record_text(record, "model", row.model);
    record_text(record, "weights", app_model_names_locate(model->source, path) ? path : NULL);
    record_text(record, "reference", row.reference);
    record_text(record, "scene", scene_path);
    record_text(record, "outcome", row.outcome);
    if (model->status) record_text(record, "message", model->message);
    record_text(record, "audit_told", *told ? told : NULL);
    app_table_record(&(AppTablePart){audit_columns, AUDIT_COUNT, &row, sizeof row}, 0, record);
    record_series(&model->audit, record);
    app_table_record(&(AppTablePart){run_columns, RUN_COUNT, &row, sizeof row}, 0, record);
    if (!model->has_run) continue;
    record_interfaces(comparison, m, record);
    Record *summary = record_child(record, "summary");
    fem_run_summarise(&model->result, summary);
  }
}

Status app_comparison_print_csv(const AppComparison *comparison, FILE *stream) {
  Row rows[APP_MAX_MODELS];
  for (int m = 0; m < comparison->model_count; m++) rows[m] = row_of(comparison, m);
  const AppTablePart parts[] = {{name_columns, NAME_COUNT, rows, sizeof *rows},
                                {audit_columns, AUDIT_COUNT, rows, sizeof *rows},
                                {run_columns, RUN_COUNT, rows, sizeof *rows}};
  return app_table_print(&(AppTable){parts, 3, comparison->model_count}, APP_TABLE_CSV, stream);
}

// One kind of error of one model.
typedef struct AuditLine {
  const char *model, *quantity;
  AppAuditFigure figure;
} AuditLine;

static const AppTableColumn line_columns[] = {
    {"model", APP_TABLE_TEXT, offsetof(AuditLine, model), "model", NULL},
    {"quantity", APP_TABLE_TEXT, offsetof(AuditLine, quantity), "", NULL},
    {"error", APP_TABLE_NUMBER, offsetof(AuditLine, figure.error), "of sums", NULL},
    {"median", APP_TABLE_NUMBER, offsetof(AuditLine, figure.median), "median", NULL},
    {"worst", APP_TABLE_NUMBER, offsetof(AuditLine, figure.worst), "worst", NULL},
    {"worst_time", APP_TABLE_NUMBER, offsetof(AuditLine, figure.worst_time), "at t [s]", NULL},
};

static Status print_audit(const AppComparison *comparison, FILE *stream) {
  static const char *const quantities[APP_AUDIT_KIND_COUNT] = {"volumes V", "forces of pairs", "nodal forces",
                                                               "total forces"};
  char told[512];
  AuditLine lines[APP_MAX_MODELS * APP_AUDIT_KIND_COUNT];
  int count = 0;
  tell_audit(comparison, told, sizeof told);
  if (*told) fprintf(stream, "audit: %s%s\n", audited_states(comparison) ? "" : "–; ", told);
  if (audited_states(comparison) == 0) return STATUS_OK;
  fprintf(
      stream,
      "audit: errors against %s, as shares, in the same %d %s of its run; sums weigh states by their size\n",
      comparison->models[comparison->reference].name, audited_states(comparison),
      audited_states(comparison) == 1 ? "state" : "states");
  for (int m = 0; m < comparison->model_count; m++) {
    const AppComparisonModel *model = &comparison->models[m];
    for (int k = 0; k < APP_AUDIT_KIND_COUNT && model->audit.count > 0; k++)
      lines[count++] = (AuditLine){k ? "" : model->name, quantities[k], model->figures[k]};
  }
  const AppTablePart part = {line_columns, sizeof line_columns / sizeof *line_columns, lines, sizeof *lines};
  return app_table_print(&(AppTable){&part, 1, count}, APP_TABLE_PLAIN, stream);
}

Status app_comparison_print_table(const AppComparison *comparison, FILE *stream) {
  Row rows[APP_MAX_MODELS];
  for (int m = 0; m < comparison->model_count; m++) rows[m] = row_of(comparison, m);
  TRY(print_audit(comparison, stream));
  fprintf(stream, "own runs: each model on its own trajectory, errors as shares; reference: %s\n",
          comparison->models[comparison->reference].name);
  const AppTablePart parts[] = {{name_columns, NAME_COUNT, rows, sizeof *rows},
                                {run_columns, RUN_COUNT, rows, sizeof *rows}};
  return app_table_print(&(AppTable){parts, 2, comparison->model_count}, APP_TABLE_PLAIN, stream);
}

void app_comparison_destroy(AppComparison *comparison) {
  for (int m = 0; m < comparison->model_count; m++) {
    overlap_model_destroy(&comparison->models[m].overlap);
    memory_free(comparison->models[m].audit.rows);
    fem_run_result_destroy(&comparison->models[m].result);
  }
  *comparison = (AppComparison){0};
}
