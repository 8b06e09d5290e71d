// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/versions.h"
#include "app/report/report.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"

// The numbers of a row: where they stand in summary.json, and what they are called.
static const struct Column {
  const char *section, *key; // section NULL: at its top
  const char *name;
} columns[] = {
    {NULL, "end_time", "end_time_s"},
    {NULL, "wall_s", "wall_s"},
    {NULL, "cpu_s", "cpu_s"},
    {NULL, "unknowns", "unknowns"},
    {NULL, "steps", "steps"},
    {"counters", "newton_iterations", "newton_iterations"},
    {"counters", "newton_failures", "newton_failures"},
    {"counters", "energy_retries", "energy_retries"},
    {NULL, "contact_force_max", "contact_force_max_N"},
    {NULL, "contact_force_last", "contact_force_last_N"},
    {NULL, "pairs_max", "pairs_max"},
    {NULL, "overlap_volume_max", "overlap_volume_max_m3"},
    {NULL, "deepest_overlap_max", "deepest_overlap_max"},
    {NULL, "energy_gain_relative", "energy_gain_relative"},
    {NULL, "energy_lost_J", "energy_lost_J"},
    {NULL, "min_det_F", "min_det_F"},
    {NULL, "peak_rss_bytes", "peak_rss_bytes"},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

static const char FORMAT[] = "tetlap-sweep 1";

Status app_sweep_table_check(const Record *table, const char *directory) {
  if (!table) return STATUS_OK;
  const char *format = record_find_text(table, "format");
  const char *program = record_find_text(record_find(table, "versions"), "tetlap");
  if (format && strcmp(format, FORMAT) == 0) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "%s/sweep.json: is of format '%s', written by tetlap %s; this program writes '%s': continue with "
      "the program that wrote it, or sweep into another folder (-o)",
      directory, format ? format : "none", program ? program : "of an unknown version", FORMAT);
}

static const Record *section_of(const AppSweepPoint *point, const struct Column *column) {
  return column->section ? record_find(point->summary, column->section) : point->summary;
}

static double value_of(const AppSweepPoint *point, const struct Column *column) {
  return record_find_number(section_of(point, column), column->key);
}

static const char *outcome_of(const AppSweepPoint *point) {
  static const char *const words[] = {[APP_SWEEP_WAITING] = "waiting",
                                      [APP_SWEEP_RESUMABLE] = "interrupted",
                                      [APP_SWEEP_RUNNING] = "running",
                                      [APP_SWEEP_FINISHED] = "finished",
                                      [APP_SWEEP_FAILED] = "failed"};
  return words[point->state];
}

static bool has_ended(const AppSweepPoint *point) {
  return point->state == APP_SWEEP_FINISHED || point->state == APP_SWEEP_FAILED;
}

static const char *value_text(const AppSweepGrid *grid, const AppSweepPoint *point, int axis) {
  return app_sweep_axis_name(&grid->base.axes[axis], point->values[axis]);
}

// A number as such, anything else, names among them, as text.
static void record_setting(Record *record, const char *key, const char *text, bool is_name) {
  if (is_name) {
    record_text(record, key, text);
    return;
  }
  char *end;
  long long whole = strtoll(text, &end, 10);
  if (end != text && !*end) {
    record_integer(record, key, whole);
    return;
  }
  double value = strtod(text, &end);
  if (end != text && !*end && isfinite(value))
    record_number(record, key, value);
  else
    record_text(record, key, text);
}

// The absolute path of each value's weights file; "": it has none.
static void record_files(const AppSweepAxis *axis, const char *scene_path, RecordList *list) {
  char path[PATH_MAX];
  for (int k = 0; k < axis->value_count; k++)
    record_append_text(list, app_sweep_axis_locate(axis, k, scene_path, path) ? path : "");
}

static void record_axes(const AppSweepGrid *grid, Record *record) {
  RecordList *list = record_list(record, "axes");
  for (int a = 0; a < grid->base.axis_count; a++) {
    const AppSweepAxis *axis = &grid->base.axes[a];
    Record *row = record_append(list);
    record_text(row, "key", axis->key);
    RecordList *values = record_list(row, "values");
    for (int k = 0; k < axis->value_count; k++) record_append_text(values, app_sweep_axis_name(axis, k));
    if (axis->labels) record_files(axis, grid->base.scene_path, record_list(row, "weights"));
  }
}

static void record_point(const AppSweepGrid *grid, const AppSweepPoint *point, Record *row) {
  record_text(row, "folder", point->folder);
  Record *set = record_child(row, "set");
  for (int a = 0; a < grid->base.axis_count; a++)
    record_setting(set, grid->base.axes[a].key, value_text(grid, point, a),
                   grid->base.axes[a].labels != NULL);
  record_text(row, "outcome", outcome_of(point));
  if (!has_ended(point)) return;
  record_integer(row, "exit_code", point->exit_code);
  if (point->message[0]) record_text(row, "message", point->message);
  if (!point->summary) return;
  for (int c = 0; c < COLUMN_COUNT; c++)
    record_value(row, columns[c].name, record_find(section_of(point, &columns[c]), columns[c].key));
}

static void record_history(const AppSweepPoint *point, Record *row) {
  const AppSweepHistory *history = point->history;
  if (!has_ended(point) || !history || history->count < 2) return;
  Record *course = record_child(row, "history");
  record_numbers(course, "time_s", history->time, history->count);
  record_numbers(course, "force_N", history->force, history->count);
}

// With the courses of the first `history_count` runs.
static Record *make_record(const AppSweepGrid *grid, int history_count) {
  Record *record = record_new();
  if (!record) return NULL;
  record_text(record, "format", FORMAT);
  record_text(record, "scene", grid->base.scene_path);
  record_text(record, "command", app_versions_command());
  app_versions_record(record_child(record, "versions"));
  record_axes(grid, record);
  RecordList *runs = record_list(record, "runs");
  for (int p = 0; p < grid->point_count; p++) {
    Record *row = record_append(runs);
    record_point(grid, &grid->points[p], row);
    if (p < history_count) record_history(&grid->points[p], row);
  }
  return record;
}

Record *app_sweep_table_record(const AppSweepGrid *grid) {
  return make_record(grid, 0);
}

// In double quotes where a comma, a quote or a line's end stands in it (RFC 4180).
static void print_text(const char *text, FILE *stream) {
  if (!strpbrk(text, ",\"\n")) {
    fputs(text, stream);
    return;
  }
  fputc('"', stream);
  for (; *text; text++) {
    if (*text == '"') fputc('"', stream);
    fputc(*text, stream);
  }
  fputc('"', stream);
}

static void print_csv_row(const AppSweepGrid *grid, const AppSweepPoint *point, FILE *stream) {
  print_text(point->folder, stream);
  for (int a = 0; a < grid->base.axis_count; a++) {
    fputc(',', stream);
    print_text(value_text(grid, point, a), stream);
  }
  fprintf(stream, ",%s", outcome_of(point));
  for (int c = 0; c < COLUMN_COUNT; c++) {
    double value = value_of(point, &columns[c]);
    fputc(',', stream);
    if (isfinite(value)) fprintf(stream, "%.17g", value);
  }
  fputc(',', stream);
  print_text(point->message, stream);
  fputc('\n', stream);
}

static Status write_csv(const AppSweepGrid *grid, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fputs("folder", writer.stream);
  for (int a = 0; a < grid->base.axis_count; a++) {
    fputc(',', writer.stream);
    print_text(grid->base.axes[a].key, writer.stream);
  }
  fputs(",outcome", writer.stream);
  for (int c = 0; c < COLUMN_COUNT; c++) fprintf(writer.stream, ",%s", columns[c].name);
  fputs(",message\n", writer.stream);
  for (int p = 0; p < grid->point_count; p++) print_csv_row(grid, &grid->points[p], writer.stream);
  return file_commit(&writer);
}

// With courses of forces: of so many runs as one can tell apart at most.
static Status write_page(const AppSweepGrid *grid, const char *path) {
  enum { MOST_HISTORIES = 200 };
  AppReport report = {.sweep = make_record(grid, MOST_HISTORIES)};
  if (!report.sweep) return status_no_memory("the page of a sweep");
  Status status = app_report_write(&report, path);
  app_report_destroy(&report);
  return status;
}

Status app_sweep_table_write(const AppSweepGrid *grid) {
  const char *directory = grid->base.directory;
  char *json = file_join(directory, "sweep.json"), *csv = file_join(directory, "sweep.csv"),
       *page = file_join(directory, "sweep.html");
  Record *table = app_sweep_table_record(grid);
  Status status = json && csv && page && table ? STATUS_OK : status_no_memory("the table of a sweep");
  if (!status) status = record_write(table, json);
  if (!status) status = write_csv(grid, csv);
  if (!status) status = write_page(grid, page);
  record_destroy(table);
  memory_free(json);
  memory_free(csv);
  memory_free(page);
  return status;
}

// What a row is called: by its folder, or, where a folder's name cannot say it, by names of models.
static void name_row(const AppSweepGrid *grid, const AppSweepPoint *point, char *text, size_t size) {
  size_t used = 0;
  bool has_names = false;
  for (int a = 0; a < grid->base.axis_count; a++) {
    const AppSweepAxis *axis = &grid->base.axes[a];
    text_append(text, size, &used, "%s%s=%s", a ? "," : "", axis->key, value_text(grid, point, a));
    has_names = has_names || axis->labels;
  }
  if (!has_names) snprintf(text, size, "%s", point->folder);
}

void app_sweep_table_print(const AppSweepGrid *grid, FILE *stream) {
  int width = (int)strlen("run");
  char name[1024];
  for (int p = 0; p < grid->point_count; p++) {
    name_row(grid, &grid->points[p], name, sizeof name);
    if ((int)strlen(name) > width) width = (int)strlen(name);
  }
  fprintf(stream, "%-*s  %-11s  %8s  %7s  %9s  %9s  %9s\n", width, "run", "outcome", "wall s", "steps",
          "force N", "deepest", "gain");
  for (int p = 0; p < grid->point_count; p++) {
    const AppSweepPoint *point = &grid->points[p];
    name_row(grid, point, name, sizeof name);
    fprintf(stream, "%-*s  %-11s", width, name, outcome_of(point));
    if (point->summary)
      fprintf(stream, "  %8.3g  %7.0f  %9.3g  %9.3g  %9.1e", record_find_number(point->summary, "wall_s"),
              record_find_number(point->summary, "steps"),
              record_find_number(point->summary, "contact_force_max"),
              record_find_number(point->summary, "deepest_overlap_max"),
              record_find_number(point->summary, "energy_gain_relative"));
    fprintf(stream, "%s%s\n", point->message[0] ? "  " : "", point->message);
  }
}
