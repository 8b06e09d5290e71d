// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/comparison.h"

#include <math.h>
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

static Status add_audit(AppAuditSums *sums, double time, const ContactAudit *audit) {
  const double errors[APP_AUDIT_KIND_COUNT] = {audit->volume_error, audit->gradient_error, audit->force_error,
                                               audit->total_error};
  size_t count = (size_t)sums->count + 1;
  if (!memory_reserve((void **)&sums->rows, &sums->capacity, count, sizeof *sums->rows))
    return status_no_memory("the audits");
  AppAuditRow *row = &sums->rows[sums->count];
  row->time = time;
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    row->errors[k] = errors[k];
    sums->sum[k] += errors[k];
    sums->max[k] = fmax(sums->max[k], errors[k]);
  }
  sums->count++;
  return STATUS_OK;
}

Status app_comparison_audit(AppComparison *comparison, const FemRunProgress *progress,
                            long long *step_in_contact) {
  if (comparison->audit_every == 0 || progress->active_pairs == 0) return STATUS_OK;
  if ((*step_in_contact)++ % comparison->audit_every != 0) return STATUS_OK;
  void *effect = fem_system_effect(progress->system, &fem_effect_contact);
  if (!effect) return STATUS_OK;
  for (int m = 0; m < comparison->model_count; m++) {
    if (m == comparison->reference) continue;
    ContactAudit audit;
    TRY(contact_system_audit(fem_effect_contact_system(effect), progress->time, progress->system->positions,
                             &comparison->models[m].overlap,
                             &comparison->models[comparison->reference].overlap, &audit));
    TRY(add_audit(&comparison->models[m].audit, progress->time, &audit));
  }
  return STATUS_OK;
}

static const char *const audit_words[APP_AUDIT_KIND_COUNT] = {"volume", "gradient", "force", "total_force"};

// What is said of one model, NaN where it does not apply.
typedef struct Row {
  const char *model, *reference, *outcome;
  double audit[APP_AUDIT_KIND_COUNT], audit_max[APP_AUDIT_KIND_COUNT]; // mean, largest
  int frames;                                                          // that both have reached; −1: no run
  double share;                                                        // of the scene's time that was reached
  AppForceError force;
  double trajectory; // relative to the scene's length
  double energy_gain, wall_s, overlap_s;
} Row;

static Row row_of(const AppComparison *comparison, int m) {
  const AppComparisonModel *model = &comparison->models[m],
                           *reference = &comparison->models[comparison->reference];
  int audits = model->audit.count;
  bool is_reference = m == comparison->reference;
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
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    row.audit[k] = audits ? model->audit.sum[k] / audits : is_reference ? 0 : NAN;
    row.audit_max[k] = audits ? model->audit.max[k] : is_reference ? 0 : NAN;
  }
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

// The audits one by one, for plots over time.
static void record_audits(const AppAuditSums *sums, Record *record) {
  if (sums->count == 0) return;
  Record *series = record_child(record, "audit_series");
  RecordList *times = record_list(series, "time_s");
  for (int i = 0; i < sums->count; i++) record_append_number(times, sums->rows[i].time);
  for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
    RecordList *errors = record_list(series, audit_words[k]);
    for (int i = 0; i < sums->count; i++) record_append_number(errors, sums->rows[i].errors[k]);
  }
}

void app_comparison_record(const AppComparison *comparison, const char *scene_path, RecordList *list) {
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
    record_integer(record, "audits", model->audit.count);
    for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) {
      char key[64];
      snprintf(key, sizeof key, "audit_%s_error", audit_words[k]);
      record_number(record, key, row.audit[k]);
      snprintf(key, sizeof key, "audit_%s_error_max", audit_words[k]);
      record_number(record, key, row.audit_max[k]);
    }
    record_audits(&model->audit, record);
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
    fprintf(stream, ",audit_%s_error,audit_%s_error_max", audit_words[k], audit_words[k]);
  fputs(",frames_compared,share_reached,force_error_l2,force_error_max,trajectory_error,energy_gain_relative,"
        "wall_s,"
        "overlap_s\n",
        stream);
  for (int m = 0; m < comparison->model_count; m++) {
    Row row = row_of(comparison, m);
    fprintf(stream, "%s,%s,%s,%d", row.model, row.reference, row.outcome, comparison->models[m].audit.count);
    for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++)
      fprintf(stream, ",%.9g,%.9g", row.audit[k], row.audit_max[k]);
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

void app_comparison_print_table(const AppComparison *comparison, FILE *stream) {
  int width = name_width(comparison);
  fprintf(stream, "reference: %s\n", comparison->models[comparison->reference].name);
  fprintf(stream, "%-*s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %s\n", width, "", "audit",
          "audit", "audit", "audit", "frames", "force", "force", "path", "energy", "wall", "overlap", "");
  // Δ and ∇ have two and three bytes.
  fprintf(stream, "%-*s  %9s  %11s  %9s  %9s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %s\n", width, "model", "ΔV",
          "Δ∇V", "Δf", "ΔF", "shared", "L2", "max", "RMS/L", "gain", "s", "s", "");
  for (int m = 0; m < comparison->model_count; m++) {
    Row row = row_of(comparison, m);
    fprintf(stream, "%-*s", width, row.model);
    for (int k = 0; k < APP_AUDIT_KIND_COUNT; k++) print_figure(stream, "%.1e", row.audit[k]);
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

void app_comparison_destroy(AppComparison *comparison) {
  for (int m = 0; m < comparison->model_count; m++) {
    overlap_model_destroy(&comparison->models[m].overlap);
    memory_free(comparison->models[m].audit.rows);
    fem_run_result_destroy(&comparison->models[m].result);
  }
  *comparison = (AppComparison){0};
}
