// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/history.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { NUMBER_BYTES = 32 }; // room for a double in 17 digits, its separator and a terminating 0

Status fem_history_create(FemHistory *history, const char *path) {
  *history = (FemHistory){0};
  return journal_create(&history->file, path);
}

void fem_history_destroy(FemHistory *history) {
  for (int c = 0; c < history->column_count; c++) memory_free(history->titles[c]);
  memory_free(history->titles);
  memory_free(history->places);
  memory_free(history->line);
  journal_destroy(&history->file);
  *history = (FemHistory){0};
}

// FNV-1a.
static uint64_t hash_of(const char *text) {
  uint64_t hash = 0xcbf29ce484222325;
  for (; *text; text++) hash = (hash ^ (unsigned char)*text) * 0x100000001b3;
  return hash;
}

// Where a title is, or would be.
static int *place_of(const FemHistory *history, const char *title) {
  size_t at = hash_of(title) & (history->place_count - 1);
  for (; history->places[at]; at = (at + 1) & (history->place_count - 1))
    if (strcmp(history->titles[history->places[at] - 1], title) == 0) break;
  return &history->places[at];
}

// Room for one more, half of the places free.
static Status make_places(FemHistory *history) {
  enum { FEW = 256 };
  if (2 * ((size_t)history->column_count + 1) <= history->place_count) return STATUS_OK;
  const size_t count = history->place_count > 0 ? 2 * history->place_count : FEW;
  int *places = memory_zeroed(count, sizeof *places);
  if (!places) return status_no_memory("a column of the history");
  memory_free(history->places);
  history->places = places, history->place_count = count;
  for (int c = 0; c < history->column_count; c++) *place_of(history, history->titles[c]) = c + 1;
  return STATUS_OK;
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

// Takes the title.
static Status add(FemHistory *history, char *title) {
  if (!memory_reserve((void **)&history->titles, &history->title_capacity, (size_t)history->column_count + 1,
                      sizeof *history->titles))
    return status_no_memory("a column of the history");
  TRY(make_places(history));
  int *place = place_of(history, title);
  if (*place)
    return status_fail(STATUS_INPUT,
                       "%s: two columns would be named %s; give one of the bodies or probes another name",
                       history->file.path, title);
  history->titles[history->column_count++] = title;
  *place = history->column_count;
  return STATUS_OK;
}

Status fem_history_add_column(FemHistory *history, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  char *title = print_title(format, arguments);
  va_end(arguments);
  if (!title) return status_no_memory("a column of the history");
  Status status = add(history, title);
  if (status) memory_free(title);
  return status;
}

static Status append(FemHistory *history, const char *text) {
  size_t length = strlen(text);
  if (!memory_reserve((void **)&history->line, &history->line_capacity, history->line_size + length, 1))
    return status_no_memory("a row of the history");
  memcpy(history->line + history->line_size, text, length);
  history->line_size += length;
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
  history->line_size = 0;
  if (history->file.end.size == 0) TRY(append_titles(history));
  TRY(append_row(history, values));
  return journal_append(&history->file, history->line, history->line_size);
}

Status fem_history_continue(FemHistory *history, JournalMark mark) {
  return journal_continue(&history->file, mark);
}
