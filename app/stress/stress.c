// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/stress.h"

#include <assert.h>
#include <stdarg.h>
#include <string.h>

#include "app/stress/limits.h"
#include "base/memory.h"
#include "base/text.h"

static const char *const outcome_names[APP_STRESS_OUTCOME_COUNT] = {"held",  "better", "tolerance",
                                                                    "limit", "absent", "FAILED"};

const char *app_stress_outcome_name(AppStressOutcome outcome) {
  return outcome_names[outcome];
}

bool app_stress_wants(const AppStressOptions *options, const char *name) {
  return !options->only || strstr(name, options->only);
}

bool app_stress_wants_model(const AppStressOptions *options, const char *model) {
  if (options->models) return text_lists(options->models, model);
  return !options->is_quick || text_lists("clip geo any", model);
}

void app_stress_destroy(AppStress *stress) {
  memory_free(stress->rows);
  memory_free(stress->names);
  *stress = (AppStress){0};
}

AppStressRow *app_stress_add(AppStress *stress, const char *group, const char *name, const char *model) {
  if (!memory_reserve((void **)&stress->rows, &stress->capacity, (size_t)stress->count + 1,
                      sizeof *stress->rows))
    return NULL;
  AppStressRow *row = &stress->rows[stress->count++];
  *row = (AppStressRow){.group = group, .name = name, .model = model};
  return row;
}

static void add_measure(AppStressRow *row, AppStressMeasure measure) {
  measure.is_met = measure.is_least ? measure.value >= measure.bound : measure.value <= measure.bound;
  assert(row->measure_count < APP_STRESS_MAX_MEASURES);
  row->measures[row->measure_count++] = measure;
}

void app_stress_ask_most(AppStressRow *row, const char *name, double value, double bound) {
  add_measure(row, (AppStressMeasure){.name = name, .value = value, .bound = bound});
}

void app_stress_ask_least(AppStressRow *row, const char *name, double value, double bound) {
  add_measure(row, (AppStressMeasure){.name = name, .value = value, .bound = bound, .is_least = true});
}

void app_stress_ask_occurred(AppStressRow *row, const char *name, double value, double least) {
  add_measure(row,
              (AppStressMeasure){
                  .name = name, .value = value, .bound = least, .is_least = true, .is_occurrence = true});
}

void app_stress_ask_end(AppStressRow *row, double time, double end) {
  add_measure(
      row, (AppStressMeasure){
               .name = "time reached", .value = time / end, .bound = 1, .is_least = true, .is_of_end = true});
}

// A run that was cut is a limit in itself; what did not come about by then is no failure.
static AppStressOutcome verdict_of(const AppStressRow *row, const AppStressMeasure *measure,
                                   const AppStressLimit *limit) {
  if (measure->is_met) return limit && !measure->is_of_end ? APP_STRESS_BETTER : APP_STRESS_HELD;
  bool is_excused = row->is_cut && (measure->is_occurrence || measure->is_of_end);
  if (limit && !is_excused)
    is_excused = measure->is_least ? measure->value >= limit->worst : measure->value <= limit->worst;
  return is_excused ? APP_STRESS_LIMIT : APP_STRESS_FAILED;
}

// Beside how far a run that was cut came stands why.
static void explain(AppStressRow *row, const AppStressLimit *limit) {
  size_t length = strlen(row->remark);
  snprintf(row->remark + length, sizeof row->remark - length, "%s%s", length > 0 ? "; " : "", limit->reason);
  row->counter = limit->counter;
}

void app_stress_judge(AppStressRow *row) {
  const AppStressLimit *first = NULL; // of those that explain what is not met
  row->outcome = row->is_cut ? APP_STRESS_LIMIT : APP_STRESS_HELD;
  for (int m = 0; m < row->measure_count; m++) {
    const AppStressMeasure *measure = &row->measures[m];
    const AppStressLimit *limit = app_stress_limits_find(row->name, row->model, measure->name);
    AppStressOutcome outcome = verdict_of(row, measure, limit);
    if (!measure->is_met && !first) first = limit;
    if (outcome > row->outcome) row->outcome = outcome;
  }
  if (first) explain(row, first);
}

void app_stress_excuse(AppStressRow *row, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(row->remark, sizeof row->remark, format, arguments);
  va_end(arguments);
  row->outcome = APP_STRESS_ABSENT;
}

int app_stress_count(const AppStress *stress, AppStressOutcome outcome) {
  int count = 0;
  for (int r = 0; r < stress->count; r++) count += stress->rows[r].outcome == outcome;
  return count;
}

// The measure that decided: the first that is not met, else NULL.
static const AppStressMeasure *decisive(const AppStressRow *row) {
  for (int m = 0; m < row->measure_count; m++)
    if (!row->measures[m].is_met) return &row->measures[m];
  return NULL;
}

static void print_row(const AppStressRow *row, FILE *stream) {
  const AppStressMeasure *measure = decisive(row);
  fprintf(stream, "%-32s %-12s %-10s %7.2f s", row->name, row->model, outcome_names[row->outcome],
          row->cpu_s);
  if (measure)
    fprintf(stream, "  %s %.2g (asked: %s %.2g)", measure->name, measure->value,
            measure->is_least ? "at least" : "at most", measure->bound);
  if (row->remark[0]) fprintf(stream, "  %s", row->remark);
  if (row->counter) fprintf(stream, " [%s]", row->counter);
  fputc('\n', stream);
}

void app_stress_print(const AppStress *stress, FILE *stream) {
  for (int r = 0; r < stress->count; r++) {
    const AppStressRow *row = &stress->rows[r];
    if (r == 0 || row->group != stress->rows[r - 1].group) fprintf(stream, "%s\n", row->group);
    print_row(row, stream);
  }
  for (int o = 0; o < APP_STRESS_OUTCOME_COUNT; o++)
    fprintf(stream, "%s%s %d", o ? ", " : "", outcome_names[o],
            app_stress_count(stress, (AppStressOutcome)o));
  fputc('\n', stream);
}

static void record_row(const AppStressRow *row, Record *record) {
  record_text(record, "group", row->group);
  record_text(record, "case", row->name);
  record_text(record, "model", row->model);
  record_text(record, "outcome", row->outcome == APP_STRESS_FAILED ? "failed" : outcome_names[row->outcome]);
  record_text(record, "remark", row->remark);
  record_text(record, "counter", row->counter);
  record_number(record, "cpu_s", row->cpu_s);
  if (row->steps > 0) record_integer(record, "steps", row->steps);
  if (row->pairs > 0) record_integer(record, "pairs", row->pairs);
  if (row->fallbacks > 0) record_integer(record, "fallbacks", row->fallbacks);
  RecordList *list = record_list(record, "measures");
  for (int m = 0; m < row->measure_count; m++) {
    const AppStressMeasure *measure = &row->measures[m];
    Record *entry = record_append(list);
    record_text(entry, "name", measure->name);
    record_number(entry, "value", measure->value);
    record_number(entry, measure->is_least ? "least" : "most", measure->bound);
    record_bool(entry, "occurrence", measure->is_occurrence);
    record_bool(entry, "met", measure->is_met);
  }
}

Status app_stress_record(const AppStress *stress, Record *record) {
  record_text(record, "format", "tetlap-stress 1");
  Record *counts = record_child(record, "counts");
  for (int o = 0; o < APP_STRESS_OUTCOME_COUNT; o++)
    record_integer(counts, o == APP_STRESS_FAILED ? "failed" : outcome_names[o],
                   app_stress_count(stress, (AppStressOutcome)o));
  RecordList *list = record_list(record, "rows");
  for (int r = 0; r < stress->count; r++) record_row(&stress->rows[r], record_append(list));
  return list ? STATUS_OK : status_no_memory("the table of hard cases");
}
