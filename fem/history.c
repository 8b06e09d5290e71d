// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/history.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"

static const double PERIOD_S = 1; // wall time between two replacements of the file [s]

enum { NUMBER_BYTES = 32 }; // room for a double in 17 digits, its separator and a terminating 0

Status fem_history_create(FemHistory *history, const char *path) {
  *history = (FemHistory){.written_at_s = -INFINITY};
  history->path = memory_copy(path, strlen(path) + 1, 1);
  return history->path ? STATUS_OK : status_no_memory("the history's name");
}

void fem_history_destroy(FemHistory *history) {
  for (int c = 0; c < history->column_count; c++) memory_free(history->titles[c]);
  memory_free(history->titles);
  memory_free(history->text);
  memory_free(history->path);
  *history = (FemHistory){0};
}

static bool has_column(const FemHistory *history, const char *title) {
  for (int c = 0; c < history->column_count; c++)
    if (strcmp(history->titles[c], title) == 0) return true;
  return false;
}

// The formatted text, owned by the caller; NULL: no memory.
static char *print_title(const char *format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, again);
  va_end(again);
  char *title = length < 0 ? NULL : memory_zeroed((size_t)length + 1, 1);
  if (title) vsnprintf(title, (size_t)length + 1, format, arguments);
  return title;
}

Status fem_history_add_column(FemHistory *history, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  char *title = print_title(format, arguments);
  va_end(arguments);
  if (!title || !memory_reserve((void **)&history->titles, &history->title_capacity,
                                (size_t)history->column_count + 1, sizeof *history->titles)) {
    memory_free(title);
    return status_no_memory("a column of the history");
  }
  Status status = STATUS_OK;
  if (has_column(history, title))
    status =
        status_fail(STATUS_INPUT, "%s: two columns would be named %s; give one of the bodies another name",
                    history->path, title);
  if (status)
    memory_free(title);
  else
    history->titles[history->column_count++] = title;
  return status;
}

static Status append(FemHistory *history, const char *text) {
  size_t length = strlen(text);
  if (!memory_reserve((void **)&history->text, &history->text_capacity, history->text_size + length, 1))
    return status_no_memory("a row of the history");
  memcpy(history->text + history->text_size, text, length);
  history->text_size += length;
  return STATUS_OK;
}

// A field of RFC 4180: in quotes if it holds a comma, a quote or a line's end, quotes doubled.
static Status append_quoted(FemHistory *history, const char *text) {
  if (!strpbrk(text, ",\"\r\n")) return append(history, text);
  TRY(append(history, "\""));
  for (; *text; text++) {
    TRY(append(history, (char[]){*text, 0}));
    if (*text == '"') TRY(append(history, "\""));
  }
  return append(history, "\"");
}

static Status append_titles(FemHistory *history) {
  for (int c = 0; c < history->column_count; c++) {
    if (c) TRY(append(history, ","));
    TRY(append_quoted(history, history->titles[c]));
  }
  return append(history, "\n");
}

// 15 digits where they read back to the same number, else 17, which always do.
static void print_number(char text[NUMBER_BYTES], double value) {
  if (isnan(value)) {
    strcpy(text, "nan"); // never "-nan", which not every reader knows
    return;
  }
  snprintf(text, NUMBER_BYTES, "%.15g", value);
  if (strtod(text, NULL) != value) snprintf(text, NUMBER_BYTES, "%.17g", value);
}

static Status append_row(FemHistory *history, const double *values) {
  for (int c = 0; c < history->column_count; c++) {
    char number[NUMBER_BYTES];
    print_number(number, values[c]);
    if (c) TRY(append(history, ","));
    TRY(append(history, number));
  }
  return append(history, "\n");
}

Status fem_history_add_row(FemHistory *history, const double *values) {
  const size_t size = history->text_size;
  Status status = history->row_count ? STATUS_OK : append_titles(history);
  if (!status) status = append_row(history, values);
  if (status) {
    history->text_size = size; // half a row never reaches the file
    return status;
  }
  history->row_count++;
  if (clock_wall_s() - history->written_at_s < PERIOD_S) return STATUS_OK;
  return fem_history_write(history);
}

Status fem_history_continue(FemHistory *history, const char *text, int row_count) {
  TRY(append(history, text));
  history->row_count = row_count;
  return STATUS_OK;
}

Status fem_history_write(FemHistory *history) {
  if (history->written_rows == history->row_count) return STATUS_OK;
  FileWriter writer;
  TRY(file_begin(&writer, history->path));
  fwrite(history->text, 1, history->text_size, writer.stream);
  TRY(file_commit(&writer));
  history->written_rows = history->row_count;
  history->written_at_s = clock_wall_s();
  return STATUS_OK;
}
