// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/comparison.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/format.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"

int app_comparison_common_frames(const FemRunResult *a, const FemRunResult *b) {
  return a->frame_count < b->frame_count ? a->frame_count : b->frame_count;
}

// Over the interfaces from `first` to before `last`.
static AppForceError force_error(const FemRunResult *result, const FemRunResult *reference, int first,
                                 int last) {
  double difference = 0, size = 0, largest_difference = 0, largest = 0;
  for (int f = 0; f < app_comparison_common_frames(result, reference); f++)
    for (int i = first; i < last; i++) {
      size_t at = 3 * ((size_t)f * (size_t)reference->interface_count + (size_t)i);
      Vec3 force = vec3_at(reference->interface_forces + at);
      Vec3 change = vec3_sub(vec3_at(result->interface_forces + at), force);
      difference += vec3_dot(change, change);
      size += vec3_dot(force, force);
      largest_difference = fmax(largest_difference, vec3_length(change));
      largest = fmax(largest, vec3_length(force));
    }
  if (!(size > 0)) return (AppForceError){NAN, NAN};
  return (AppForceError){sqrt(difference / size), largest_difference / largest};
}

AppForceError app_comparison_force_error(const FemRunResult *result, const FemRunResult *reference) {
  return force_error(result, reference, 0, reference->interface_count);
}

AppForceError app_comparison_interface_error(const FemRunResult *result, const FemRunResult *reference,
                                             int interface) {
  return force_error(result, reference, interface, interface + 1);
}

double app_comparison_trajectory_error(const FemRunResult *result, const FemRunResult *reference) {
  int frames = app_comparison_common_frames(result, reference);
  size_t count = (size_t)frames * (size_t)reference->vertex_count;
  double sum = 0;
  for (size_t i = 0; i < 3 * count; i++) {
    double change = result->trajectory[i] - reference->trajectory[i];
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

static int compare_errors(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
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
  qsort(errors, (size_t)audit->count, sizeof *errors, compare_errors);
  figure->median = 0.5 * (errors[(audit->count - 1) / 2] + errors[audit->count / 2]);
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

void app_comparison_tell_audit(const AppComparison *comparison, char *text, size_t size) {
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
  if (comparison->audit_every == 0 || contact_system_mesh_pair_count(contact) == 0) return STATUS_OK;
  if ((*step_in_contact)++ % comparison->audit_every != 0) return STATUS_OK;
  for (int m = 0; m < comparison->model_count; m++) {
    if (m == comparison->reference) continue;
    ContactAudit state;
    TRY(contact_system_audit(contact, progress->time, progress->system->accepted.positions,
                             &comparison->models[m].overlap,
                             &comparison->models[comparison->reference].overlap, &state));
    TRY(app_audit_add(&comparison->models[m].audit, progress->time, &state));
  }
  return STATUS_OK;
}

static const char *const audit_words[APP_AUDIT_KIND_COUNT] = {"volume", "gradient", "force", "total_force"};

// What is said of one model, NaN where it does not apply.
typedef struct Row {
  const char *model, *reference, *outcome;
  int frames;   // that both have reached; −1: no run
  double share; // of the scene's time that was reached
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
             .frames = -1,
             .share = NAN,
             .force = {NAN, NAN},
             .trajectory = NAN,
             .energy_gain = NAN,
             .wall_s = NAN,
             .overlap_s = NAN};
  if (!model->has_run) return row;
  row.frames = app_comparison_common_frames(&model->result, &reference->result);
  row.share = model->result.end_time / comparison->end;
  row.force = app_comparison_force_error(&model->result, &reference->result);
  row.trajectory = app_comparison_trajectory_error(&model->result, &reference->result) / comparison->length;
  row.energy_gain = model->result.audit.gain / model->result.audit.scale;
  row.wall_s = model->result.wall_s;
  row.overlap_s = model->result.phases.overlap;
  return row;
}

static void record_interfaces(const AppComparison *comparison, int m, Record *record) {
  const FemRunResult *result = &comparison->models[m].result,
                     *reference = &comparison->models[comparison->reference].result;
  RecordList *list = record_list(record, "interfaces");
  for (int i = 0; i < reference->interface_count; i++) {
    AppForceError error = app_comparison_interface_error(result, reference, i);
    Record *one = record_append(list);
    record_text(one, "name", reference->interface_names[i]);
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

enum { AUDIT_PARTS = 4 };
static const char *const audit_parts[AUDIT_PARTS] = {"", "_median", "_worst", "_worst_time"};

// In the order of audit_parts.
static void list_parts(const AppAuditFigure *figure, double parts[AUDIT_PARTS]) {
  parts[0] = figure->error, parts[1] = figure->median;
  parts[2] = figure->worst, parts[3] = figure->worst_time;
}

static void record_audit(const AppComparisonModel *model, const char *told, Record *record) {
  record_integer(record, "audits", model->audit.count);
  record_text(record, "audit_told", *told ? told : NULL);
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    double parts[AUDIT_PARTS];
    list_parts(&model->figures[k], parts);
    for (int p = 0; p < AUDIT_PARTS; p++) {
      char key[64];
      snprintf(key, sizeof key, "audit_%s_error%s", audit_words[k], audit_parts[p]);
      record_number(record, key, parts[p]);
    }
  }
  record_series(&model->audit, record);
}

void app_comparison_record(const AppComparison *comparison, const char *scene_path, RecordList *list) {
  char told[512];
  app_comparison_tell_audit(comparison, told, sizeof told);
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
    record_audit(model, told, record);
    if (model->has_run) record_integer(record, "frames_compared", row.frames);
    record_number(record, "share_reached", row.share);
    record_number(record, "force_error_l2", row.force.l2);
    record_number(record, "force_error_max", row.force.max);
    record_number(record, "trajectory_error", row.trajectory);
    record_number(record, "energy_gain_relative", row.energy_gain);
    record_number(record, "wall_s", row.wall_s);
    if (!model->has_run) continue;
    record_interfaces(comparison, m, record);
    Record *summary = record_child(record, "summary");
    fem_run_summarise(&model->result, summary);
  }
}

void app_comparison_print_csv(const AppComparison *comparison, FILE *stream) {
  fputs("model,reference,outcome,audits", stream);
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++)
    for (int p = 0; p < AUDIT_PARTS; p++)
      fprintf(stream, ",audit_%s_error%s", audit_words[k], audit_parts[p]);
  fputs(",frames_compared,share_reached,force_error_l2,force_error_max,trajectory_error,energy_gain_relative,"
        "wall_s,"
        "overlap_s\n",
        stream);
  for (int m = 0; m < comparison->model_count; m++) {
    Row row = row_of(comparison, m);
    fprintf(stream, "%s,%s,%s,%d", row.model, row.reference, row.outcome, comparison->models[m].audit.count);
    for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
      double parts[AUDIT_PARTS];
      list_parts(&comparison->models[m].figures[k], parts);
      for (int p = 0; p < AUDIT_PARTS; p++) fprintf(stream, isnan(parts[p]) ? "," : ",%.9g", parts[p]);
    }
    fprintf(stream, ",%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", row.frames, row.share, row.force.l2,
            row.force.max, row.trajectory, row.energy_gain, row.wall_s, row.overlap_s);
  }
}

// A figure in eight columns, "–" where there is none.
static void print_figure(FILE *stream, const char *format, double value) {
  char text[32];
  snprintf(text, sizeof text, format, value);
  fprintf(stream, isnan(value) ? "  %10s" : "  %8s", isnan(value) ? "–" : text); // the dash has three bytes
}

// Of the column with the models' names.
static int name_width(const AppComparison *comparison) {
  int width = 12;
  for (int m = 0; m < comparison->model_count; m++) {
    int length = (int)strlen(comparison->models[m].name);
    if (length > width) width = length;
  }
  return width;
}

static void print_audit(const AppComparison *comparison, FILE *stream) {
  static const char *const quantities[APP_AUDIT_KIND_COUNT] = {"volumes V", "gradients ∇V", "nodal forces",
                                                               "total forces"};
  char told[512];
  app_comparison_tell_audit(comparison, told, sizeof told);
  if (*told) fprintf(stream, "audit: %s%s\n", audited_states(comparison) ? "" : "–; ", told);
  if (audited_states(comparison) == 0) return;
  fprintf(stream, "audit: errors against %s in the same %d %s of its run; sums weigh states by their size\n",
          comparison->models[comparison->reference].name, audited_states(comparison),
          audited_states(comparison) == 1 ? "state" : "states");
  int width = name_width(comparison);
  fprintf(stream, "%-*s  %-12s  %8s  %8s  %8s  %10s\n", width, "model", "", "of sums", "median", "worst",
          "at t [s]");
  for (int m = 0; m < comparison->model_count; m++) {
    const AppComparisonModel *model = &comparison->models[m];
    for (int k = 0; k < APP_AUDIT_KIND_COUNT && model->audit.count > 0; k++) {
      const AppAuditFigure *figure = &model->figures[k];
      fprintf(stream, "%-*s  %-*s", width, k ? "" : model->name, k == APP_AUDIT_GRADIENT ? 14 : 12,
              quantities[k]);
      print_figure(stream, "%.1e", figure->error);
      print_figure(stream, "%.1e", figure->median);
      print_figure(stream, "%.1e", figure->worst);
      fprintf(stream, "  %10.6g\n", figure->worst_time);
    }
  }
}

static void print_runs(const AppComparison *comparison, FILE *stream) {
  int width = name_width(comparison);
  fprintf(stream, "%-*s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %s\n", width, "", "frames", "force", "force",
          "path", "energy", "wall", "overlap", "");
  fprintf(stream, "%-*s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %s\n", width, "model", "shared", "L2", "max",
          "RMS/L", "gain", "s", "s", "");
  for (int m = 0; m < comparison->model_count; m++) {
    Row row = row_of(comparison, m);
    fprintf(stream, "%-*s", width, row.model);
    print_figure(stream, "%.0f", row.frames < 0 ? NAN : (double)row.frames);
    print_figure(stream, "%.1e", row.force.l2);
    print_figure(stream, "%.1e", row.force.max);
    print_figure(stream, "%.1e", row.trajectory);
    print_figure(stream, "%.1e", row.energy_gain);
    print_figure(stream, "%.2f", row.wall_s);
    print_figure(stream, "%.2f", row.overlap_s);
    fprintf(stream, "  %s", row.outcome);
    if (row.share < 1) fprintf(stream, " at %.3g %% of the time", 100 * row.share);
    fputc('\n', stream);
  }
}

void app_comparison_print_table(const AppComparison *comparison, FILE *stream) {
  print_audit(comparison, stream);
  fprintf(stream, "own runs: each model on its own trajectory; reference: %s\n",
          comparison->models[comparison->reference].name);
  print_runs(comparison, stream);
}

void app_comparison_destroy(AppComparison *comparison) {
  for (int m = 0; m < comparison->model_count; m++) {
    overlap_model_destroy(&comparison->models[m].overlap);
    memory_free(comparison->models[m].audit.rows);
    fem_run_result_destroy(&comparison->models[m].result);
  }
  *comparison = (AppComparison){0};
}
