// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/named.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

enum { MOST_COLUMNS = 32, MOST_NAME = 64, TEXT_SIZE = 1024, FIRST_QUANTITY = 6 };

typedef struct Table {
  char *text, *path; // owned
  char titles[MOST_COLUMNS][MOST_NAME];
  int column_count, time, way;
  const char *rows; // into `text`
} Table;

static void close_table(Table *table) {
  memory_free(table->text);
  memory_free(table->path);
  *table = (Table){0};
}

static int find_title(const Table *table, const char *title) {
  for (int k = 0; k < table->column_count; k++)
    if (strcmp(table->titles[k], title) == 0) return k;
  return -1;
}

static char *path_of(const char *directory, int frame) {
  char name[32];
  snprintf(name, sizeof name, "lines_%05d.csv", frame);
  return file_join(directory, name);
}

static Status read_titles(Table *table) {
  const char *end = strchr(table->text, '\n');
  if (end) {
    table->rows = end + 1;
    for (const char *at = table->text; at < end && table->column_count < MOST_COLUMNS; at++) {
      size_t size = strcspn(at, ",\n");
      snprintf(table->titles[table->column_count++], MOST_NAME, "%.*s", (int)size, at);
      at += size;
    }
  }
  table->time = find_title(table, "time_s"), table->way = find_title(table, "way_m");
  if (table->time > 0 && table->way > 0 && find_title(table, "line") == 0) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: is no file of lines; its first line lacks line,time_s,way_m",
                     table->path);
}

static Status open_table(Table *table, const char *directory, int frame) {
  size_t size;
  *table = (Table){.path = path_of(directory, frame)};
  if (!table->path) return status_no_memory("a file name");
  Status status = file_read(table->path, &table->text, &size);
  if (!status) status = read_titles(table);
  if (status) close_table(table);
  return status;
}

// The numbers of a row, of its first column NaN; where the next one begins. NULL: it is none.
static const char *read_row(const Table *table, const char *row, double *numbers) {
  numbers[0] = NAN;
  row += strcspn(row, ",\n");
  for (int k = 1; k < table->column_count; k++) {
    char *end;
    if (*row != ',' || strchr(" \t\r\n", row[1])) return NULL; // strtod would read on in the next row
    numbers[k] = strtod(row + 1, &end);
    if (end == row + 1 || !strchr(",\n", *end)) return NULL;
    row = end;
  }
  return *row == '\n' ? row + 1 : NULL;
}

static Status fail_row(const Table *table, const char *row) {
  int number = 1;
  for (const char *at = table->text; at < row; at++) number += *at == '\n';
  return status_fail(STATUS_INPUT, "%s:%d: expected a name and %d numbers", table->path, number,
                     table->column_count - 1);
}

static Status read_time(const char *directory, int frame, double *time) {
  Table table;
  double numbers[MOST_COLUMNS];
  TRY(open_table(&table, directory, frame));
  Status status = read_row(&table, table.rows, numbers) ? STATUS_OK : fail_row(&table, table.rows);
  if (!status) *time = numbers[table.time];
  close_table(&table);
  return status;
}

static bool has_frame(const char *directory, int frame) {
  char *path = path_of(directory, frame);
  bool is_there = path && file_exists(path);
  memory_free(path);
  return is_there;
}

Status app_plot_named_frames(const char *directory, FemPvdList *frames) {
  size_t capacity = 0;
  Status status = STATUS_OK;
  *frames = (FemPvdList){0};
  for (; has_frame(directory, frames->count) && !status; frames->count++) {
    bool fits =
        memory_reserve((void **)&frames->times, &capacity, (size_t)frames->count + 1, sizeof *frames->times);
    status = fits ? read_time(directory, frames->count, &frames->times[frames->count])
                  : status_no_memory("the times of lines");
  }
  if (!status && frames->count == 0)
    status =
        status_fail(STATUS_INPUT, "%s: has no lines_00000.csv; give the scene bodies[].lines", directory);
  if (status) fem_pvd_destroy(frames);
  return status;
}

// The title of column k without its unit.
static void name_column(const Table *table, int k, char name[MOST_NAME]) {
  snprintf(name, MOST_NAME, "%s", table->titles[k]);
  char *unit = strrchr(name, '_');
  if (unit) *unit = 0;
}

// Whether the column has that name, or with a component that of a component.
static bool is_called(const Table *table, int k, const char *name, char component) {
  char own[MOST_NAME], wanted[MOST_NAME];
  name_column(table, k, own);
  snprintf(wanted, sizeof wanted, component ? "%s_%c" : "%s", name, component);
  return strcmp(own, wanted) == 0;
}

// The columns of a quantity: one, or three of a vector.
static Status find_columns(const Table *table, const char *quantity, int columns[3], int *count) {
  char name[MOST_NAME], there[TEXT_SIZE] = "";
  snprintf(name, sizeof name, "%s", quantity);
  char *colon = strchr(name, ':');
  if (colon) *colon = '_';
  *count = 0;
  for (int k = FIRST_QUANTITY; k < table->column_count; k++) {
    if (is_called(table, k, name, 0)) {
      columns[0] = k, *count = 1;
      return STATUS_OK;
    }
    if (*count < 3 && is_called(table, k, name, "xyz"[*count])) columns[(*count)++] = k;
  }
  if (*count == 3) return STATUS_OK;
  for (int k = FIRST_QUANTITY; k < table->column_count; k++) {
    char own[MOST_NAME];
    size_t length = strlen(there);
    name_column(table, k, own);
    char *last = strrchr(own, '_');
    if (last && strspn(last + 1, "xyz") == strlen(last + 1)) *last = ':';
    snprintf(there + length, sizeof there - length, "%s%s", length ? ", " : "", own);
  }
  return status_fail(STATUS_INPUT, "%s: has no '%s' along lines; it has %s", table->path, quantity, there);
}

static bool is_of(const char *row, const char *name) {
  size_t length = strlen(name);
  return strcspn(row, ",\n") == length && strncmp(row, name, length) == 0;
}

static Status fail_name(const Table *table, const char *name) {
  char there[TEXT_SIZE] = "";
  const char *last = NULL;
  for (const char *row = table->rows; *row; row += strcspn(row, "\n"), row += *row == '\n') {
    size_t size = strcspn(row, ",\n"), length = strlen(there);
    if (last && strcspn(last, ",\n") == size && strncmp(last, row, size) == 0) continue;
    snprintf(there + length, sizeof there - length, "%s%.*s", length ? ", " : "", (int)size, row);
    last = row;
  }
  return status_fail(STATUS_INPUT, "%s: has no line '%s'; it has %s", table->path, name, there);
}

static Status read_points(AppPlotPoints *points, const Table *table, const char *name, const int columns[3],
                          int count) {
  bool is_there = false;
  double numbers[MOST_COLUMNS];
  for (const char *row = table->rows, *next; *row; row = next) {
    next = read_row(table, row, numbers);
    if (!next) return fail_row(table, row);
    if (!is_of(row, name)) continue;
    is_there = true;
    double value = numbers[columns[0]];
    if (count == 3) value = hypot(hypot(value, numbers[columns[1]]), numbers[columns[2]]);
    if (!isfinite(value)) continue;
    if (!memory_reserve((void **)&points->points, &points->capacity, (size_t)points->count + 1,
                        sizeof *points->points))
      return status_no_memory("points of a line");
    points->points[points->count++] = (AppPlotPoint){.along = numbers[table->way], .value = value};
  }
  return is_there ? STATUS_OK : fail_name(table, name);
}

Status app_plot_named_read(AppPlotPoints *points, const char *directory, int frame, const char *name,
                           const char *quantity) {
  Table table;
  int columns[3], count;
  TRY(open_table(&table, directory, frame));
  Status status = find_columns(&table, quantity, columns, &count);
  if (!status) status = read_points(points, &table, name, columns, count);
  close_table(&table);
  return status;
}
