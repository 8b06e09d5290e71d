// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/versions.h"
#include "app/report/report.h"
#include "app/sweep/order.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/sorted.h"
#include "base/text.h"

// The numbers of a row: where they stand in summary.json, what they are called, and above their column of the
// terminal's table (NULL: there is none).
static const struct Column {
  const char *section, *key; // section NULL: at its top
  const char *name, *head;
  AppTableKind kind;
} columns[] = {
    {NULL, "end_time", "end_time_s", NULL, APP_TABLE_NUMBER},
    {NULL, "wall_s", "wall_s", "wall s", APP_TABLE_NUMBER},
    {NULL, "cpu_s", "cpu_s", "cpu s", APP_TABLE_NUMBER},
    {NULL, "unknowns", "unknowns", NULL, APP_TABLE_COUNT},
    {NULL, "steps", "steps", "steps", APP_TABLE_COUNT},
    {"counters", "newton_iterations", "newton_iterations", "Newton", APP_TABLE_COUNT},
    {"counters", "newton_failures", "newton_failures", NULL, APP_TABLE_COUNT},
    {"counters", "energy_retries", "energy_retries", NULL, APP_TABLE_COUNT},
    {"counters", "factorisations", "factorisations", NULL, APP_TABLE_COUNT},
    {"counters", "linear_solves", "linear_solves", NULL, APP_TABLE_COUNT},
    {"counters", "linear_iterations", "linear_iterations", NULL, APP_TABLE_COUNT},
    {"phases", "start", "start_s", NULL, APP_TABLE_NUMBER},
    {"phases", "broad_phase", "broad_phase_s", NULL, APP_TABLE_NUMBER},
    {"phases", "overlap", "overlap_s", NULL, APP_TABLE_NUMBER},
    {"phases", "contact", "contact_s", NULL, APP_TABLE_NUMBER},
    {"phases", "forces", "forces_s", NULL, APP_TABLE_NUMBER},
    {"phases", "layout", "layout_s", NULL, APP_TABLE_NUMBER},
    {"phases", "assembly", "assembly_s", NULL, APP_TABLE_NUMBER},
    {"phases", "analysis", "analysis_s", NULL, APP_TABLE_NUMBER},
    {"phases", "factorisation", "factorisation_s", NULL, APP_TABLE_NUMBER},
    {"phases", "solve", "solve_s", NULL, APP_TABLE_NUMBER},
    {"phases", "products", "products_s", NULL, APP_TABLE_NUMBER},
    {"phases", "integration", "integration_s", NULL, APP_TABLE_NUMBER},
    {"phases", "measures", "measures_s", NULL, APP_TABLE_NUMBER},
    {"phases", "output", "output_s", NULL, APP_TABLE_NUMBER},
    {"phases", "other", "other_s", NULL, APP_TABLE_NUMBER},
    {NULL, "contact_force_max", "contact_force_max_N", "force N", APP_TABLE_NUMBER},
    {NULL, "contact_force_last", "contact_force_last_N", NULL, APP_TABLE_NUMBER},
    {NULL, "pairs_max", "pairs_max", NULL, APP_TABLE_COUNT},
    {NULL, "overlap_volume_max", "overlap_volume_max_m3", NULL, APP_TABLE_NUMBER},
    {NULL, "deepest_overlap_max", "deepest_overlap_max", "deepest", APP_TABLE_NUMBER},
    {NULL, "energy_gain_relative", "energy_gain_relative", "gain", APP_TABLE_NUMBER},
    {NULL, "energy_lost_J", "energy_lost_J", NULL, APP_TABLE_NUMBER},
    {NULL, "min_det_F", "min_det_F", NULL, APP_TABLE_NUMBER},
    {NULL, "peak_rss_bytes", "peak_rss_bytes", NULL, APP_TABLE_COUNT},
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
  RecordList *linked = NULL;
  for (int a = 0; a < grid->base.axis_count; a++) {
    const AppSweepAxis *axis = &grid->base.axes[a];
    bool has_linked = a + 1 < grid->base.axis_count && axis[1].is_linked;
    Record *row = record_append(axis->is_linked ? linked : list);
    if (!axis->is_linked) linked = has_linked ? record_list(row, "with") : NULL;
    record_text(row, "key", axis->key);
    RecordList *values = record_list(row, "values");
    for (int k = 0; k < axis->value_count; k++) record_append_text(values, app_sweep_axis_name(axis, k));
    if (axis->labels) record_files(axis, grid->base.scene_path, record_list(row, "weights"));
  }
}

// The first axis with three values, along which orders are observed; -1: there is none.
static int order_axis(const AppSweepBase *base) {
  for (int a = 0; a < base->axis_count; a++)
    if (!base->axes[a].is_linked && base->axes[a].value_count >= 3) return a;
  return -1;
}

// The observed order of the last contact force along that axis up to this point's value; NaN: there is none.
static double order_of(const AppSweepGrid *grid, int p) {
  const AppSweepBase *base = &grid->base;
  int along = order_axis(base), stride = app_sweep_point_count(base) / base->repeat_count;
  int k = along < 0 ? 0 : grid->points[p].values[along];
  if (k < 2) return NAN;
  for (int a = 0; a <= along; a++)
    if (!base->axes[a].is_linked) stride /= base->axes[a].value_count;
  char *const *texts = base->axes[along].values;
  const char *const values[3] = {texts[k - 2], texts[k - 1], texts[k]};
  double force[3];
  for (int i = 0; i < 3; i++)
    force[i] = record_find_number(grid->points[p - (2 - i) * stride].summary, "contact_force_last");
  return app_sweep_order_observed(values, force);
}

static bool has_orders(const AppSweepGrid *grid) {
  for (int p = 0; p < grid->point_count; p++)
    if (isfinite(order_of(grid, p))) return true;
  return false;
}

static void record_point(const AppSweepGrid *grid, const AppSweepPoint *point, Record *row) {
  record_text(row, "folder", point->folder);
  Record *set = record_child(row, "set");
  for (int a = 0; a < grid->base.axis_count; a++)
    record_setting(set, grid->base.axes[a].key, value_text(grid, point, a),
                   grid->base.axes[a].labels != NULL);
  if (grid->base.repeat_count > 1) record_integer(row, "repeat", point->repeat + 1);
  record_text(row, "outcome", outcome_of(point));
  if (!has_ended(point)) return;
  record_integer(row, "exit_code", point->exit_code);
  if (point->message[0]) record_text(row, "message", point->message);
  if (!point->summary) return;
  for (int c = 0; c < COLUMN_COUNT; c++)
    record_value(row, columns[c].name, record_find(section_of(point, &columns[c]), columns[c].key));
  double order = order_of(grid, (int)(point - grid->points));
  if (isfinite(order)) record_number(row, "order", order);
}

static void record_history(const AppSweepPoint *point, Record *row) {
  const AppSweepHistory *history = point->history;
  if (!has_ended(point) || !history || history->count < 2) return;
  Record *course = record_child(row, "history");
  record_numbers(course, "time_s", history->time, history->count);
  record_numbers(course, "force_N", history->force, history->count);
}

// The first `count` runs, with the courses of the first `history_count`.
static Record *make_record(const AppSweepGrid *grid, int count, int history_count) {
  Record *record = record_new();
  if (!record) return NULL;
  record_text(record, "format", FORMAT);
  record_text(record, "scene", grid->base.scene_path);
  record_text(record, "command", app_versions_command());
  app_versions_record(record_child(record, "versions"));
  record_axes(grid, record);
  if (has_orders(grid)) record_text(record, "order_along", grid->base.axes[order_axis(&grid->base)].key);
  RecordList *runs = record_list(record, "runs");
  for (int p = 0; p < count; p++) {
    Record *row = record_append(runs);
    record_point(grid, &grid->points[p], row);
    if (p < history_count) record_history(&grid->points[p], row);
  }
  return record;
}

Record *app_sweep_table_record(const AppSweepGrid *grid) {
  return make_record(grid, grid->point_count, 0);
}

// A run, or what runs of the same values have in common.
typedef struct Row {
  const char *folder, *name, *outcome, *message, *values[APP_SWEEP_MAX_AXES];
  char text[1024]; // that `name` points to
  double repeat, spread, order, numbers[COLUMN_COUNT];
} Row;

typedef struct Columns {
  AppTableColumn columns[APP_SWEEP_MAX_AXES + COLUMN_COUNT + 7];
  int count;
} Columns;

static void add_column(Columns *list, const char *key, AppTableKind kind, size_t offset, const char *head) {
  list->columns[list->count++] = (AppTableColumn){.key = key, .kind = kind, .offset = offset, .head = head};
}

// The numbers; on a terminal those with a head alone, and, of repeated runs, how far processor times are
// apart.
static void add_numbers(Columns *list, bool is_terminal, bool is_repeated) {
  for (int c = 0; c < COLUMN_COUNT; c++) {
    if (is_terminal && !columns[c].head) continue;
    add_column(list, columns[c].name, columns[c].kind, offsetof(Row, numbers) + (size_t)c * sizeof(double),
               columns[c].head);
    if (is_terminal && is_repeated && strcmp(columns[c].name, "cpu_s") == 0)
      add_column(list, "spread", APP_TABLE_NUMBER, offsetof(Row, spread), "spread");
  }
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

static void fill_row(const AppSweepGrid *grid, const AppSweepPoint *point, Row *row) {
  *row = (Row){.folder = point->folder,
               .outcome = outcome_of(point),
               .message = point->message,
               .repeat = point->repeat + 1,
               .spread = NAN,
               .order = order_of(grid, (int)(point - grid->points))};
  for (int a = 0; a < grid->base.axis_count; a++) row->values[a] = value_text(grid, point, a);
  for (int c = 0; c < COLUMN_COUNT; c++) row->numbers[c] = value_of(point, &columns[c]);
  name_row(grid, point, row->text, sizeof row->text);
  row->name = row->text;
}

static Status print_rows(const Columns *list, const Row *rows, int count, AppTableFormat format,
                         FILE *stream) {
  const AppTablePart part = {list->columns, list->count, rows, sizeof *rows};
  return app_table_print(&(AppTable){&part, 1, count}, format, stream);
}

static Status print_csv(const AppSweepGrid *grid, FILE *stream) {
  Columns list = {.count = 0};
  Row *rows = memory_zeroed((size_t)grid->point_count, sizeof *rows);
  if (!rows) return status_no_memory("the table of a sweep");
  for (int p = 0; p < grid->point_count; p++) fill_row(grid, &grid->points[p], &rows[p]);
  add_column(&list, "folder", APP_TABLE_TEXT, offsetof(Row, folder), NULL);
  for (int a = 0; a < grid->base.axis_count; a++)
    add_column(&list, grid->base.axes[a].key, APP_TABLE_TEXT,
               offsetof(Row, values) + (size_t)a * sizeof(const char *), NULL);
  if (grid->base.repeat_count > 1) add_column(&list, "repeat", APP_TABLE_COUNT, offsetof(Row, repeat), NULL);
  add_column(&list, "outcome", APP_TABLE_TEXT, offsetof(Row, outcome), NULL);
  add_numbers(&list, false, false);
  if (has_orders(grid)) add_column(&list, "order", APP_TABLE_NUMBER, offsetof(Row, order), NULL);
  add_column(&list, "message", APP_TABLE_TEXT, offsetof(Row, message), NULL);
  Status status = print_rows(&list, rows, grid->point_count, APP_TABLE_CSV, stream);
  memory_free(rows);
  return status;
}

static Status write_csv(const AppSweepGrid *grid, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = print_csv(grid, writer.stream);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

// Without repeated runs; with courses of forces, of so many runs as one can tell apart at most.
static Status write_page(const AppSweepGrid *grid, const char *path) {
  enum { MOST_HISTORIES = 200 };
  AppReport report = {.sweep =
                          make_record(grid, grid->point_count / grid->base.repeat_count, MOST_HISTORIES)};
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

// The median of a column over the runs of one combination of values, and how far they are apart over it.
static double median_of(const AppSweepGrid *grid, int row, const struct Column *column, double *spread) {
  double values[APP_SWEEP_MAX_REPEATS];
  int count = 0, rows = grid->point_count / grid->base.repeat_count;
  for (int p = row; p < grid->point_count; p += rows) {
    double value = value_of(&grid->points[p], column);
    if (isfinite(value)) values[count++] = value;
  }
  *spread = NAN;
  if (count == 0) return NAN;
  sorted_values(values, (size_t)count);
  double median = sorted_median(values, (size_t)count);
  if (count > 1) *spread = (values[count - 1] - values[0]) / median;
  return median;
}

// Of the runs of a combination the first that has not finished; where all have, the first.
static const AppSweepPoint *worst_of(const AppSweepGrid *grid, int row) {
  for (int p = row; p < grid->point_count; p += grid->point_count / grid->base.repeat_count)
    if (grid->points[p].state != APP_SWEEP_FINISHED) return &grid->points[p];
  return &grid->points[row];
}

Status app_sweep_table_print(const AppSweepGrid *grid, AppTableFormat format, FILE *stream) {
  Columns list = {.count = 0};
  int count = grid->point_count / grid->base.repeat_count;
  Row *rows = memory_zeroed((size_t)count, sizeof *rows);
  if (!rows) return status_no_memory("the table of a sweep");
  for (int r = 0; r < count; r++) {
    const AppSweepPoint *worst = worst_of(grid, r);
    fill_row(grid, &grid->points[r], &rows[r]);
    rows[r].outcome = outcome_of(worst), rows[r].message = worst->message;
    for (int c = 0; c < COLUMN_COUNT; c++) {
      double spread;
      rows[r].numbers[c] = median_of(grid, r, &columns[c], &spread);
      if (strcmp(columns[c].name, "cpu_s") == 0) rows[r].spread = spread;
    }
  }
  add_column(&list, "run", APP_TABLE_TEXT, offsetof(Row, name), "run");
  add_column(&list, "outcome", APP_TABLE_TEXT, offsetof(Row, outcome), "outcome");
  add_numbers(&list, true, grid->base.repeat_count > 1);
  if (has_orders(grid)) add_column(&list, "order", APP_TABLE_NUMBER, offsetof(Row, order), "order");
  add_column(&list, "message", APP_TABLE_TEXT, offsetof(Row, message), "");
  Status status = print_rows(&list, rows, count, format, stream);
  memory_free(rows);
  return status;
}
