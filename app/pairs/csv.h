// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of numbers as text: a row a line; commas, semicolons, or blanks between; with or without a header.
// Empty lines and those that begin with # are passed over.
#ifndef TETLAP_APP_PAIRS_CSV_H
#define TETLAP_APP_PAIRS_CSV_H

#include <stdbool.h>
#include <stdio.h>

#include "app/pairs/columns.h"

typedef struct AppPairsCsv {
  FILE *stream;                              // borrowed
  const char *name;                          // the file's, for messages; borrowed
  char *line;                                // the last one read, cut at its separators; owned
  size_t capacity;                           // of `line`, in bytes
  long long line_number;                     // its own, from 1
  char separator;                            // ',' or ';'; ' ': blanks
  const char *fields[APP_PAIRS_MAX_COLUMNS]; // of the line; borrowed from it
  int field_places[APP_PAIRS_MAX_COLUMNS];   // their columns in the line, in characters from 1
  int field_count;
  bool has_header; // the first line was none of numbers: `fields` are its names
  bool is_pending; // the line has been read but not asked for
} AppPairsCsv;

// Reads the first line: either names, or numbers, which the first call of read gives again. STATUS_INPUT:
// there is none, or it is no text; messages begin with file and line.
Status app_pairs_csv_open(AppPairsCsv *csv, FILE *stream, const char *name);

// The next line's numbers into `row` (count). `*is_end`: there was none. STATUS_INPUT: a line of another
// count, or a field that is no finite number; the message names file, line and column.
Status app_pairs_csv_read(AppPairsCsv *csv, int count, double *row, bool *is_end);

void app_pairs_csv_close(AppPairsCsv *csv);

#endif
