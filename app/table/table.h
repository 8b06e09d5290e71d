// SPDX-License-Identifier: GPL-3.0-or-later
// Tables: rows as structs, and columns that say where in a row a value lies and what it is. One table is
// printed for a terminal, as Markdown, as CSV, or as JSON, an object a row.
#ifndef TETLAP_APP_TABLE_TABLE_H
#define TETLAP_APP_TABLE_TABLE_H

#include <stddef.h>
#include <stdio.h>

#include "base/files/record.h"
#include "base/status.h"

typedef enum AppTableKind {
  APP_TABLE_TEXT,    // const char *; NULL: empty
  APP_TABLE_INTEGER, // long long
  APP_TABLE_NUMBER,  // double; NaN: not measured (null in JSON)
  APP_TABLE_COUNT,   // likewise, a whole number
} AppTableKind;

typedef struct AppTableColumn {
  const char *key; // in JSON and CSV
  AppTableKind kind;
  size_t offset;    // in the row
  const char *head; // above the column on a terminal and in Markdown; NULL: JSON and CSV only
  const char *help; // what it is, with its unit; NULL: nothing is said
} AppTableColumn;

// Columns whose values lie in the same struct; a table has one part or several side by side.
typedef struct AppTablePart {
  const AppTableColumn *columns; // (column_count), borrowed
  int column_count;
  const void *rows; // (rows of the table), borrowed
  size_t row_size;  // 0: one row, the same beside all rows of the other parts
} AppTablePart;

typedef struct AppTable {
  const AppTablePart *parts; // (part_count), borrowed
  int part_count, row_count;
} AppTable;

typedef enum AppTableFormat {
  APP_TABLE_PLAIN, // for a terminal
  APP_TABLE_JSON,
  APP_TABLE_CSV,
  APP_TABLE_MARKDOWN,
} AppTableFormat;

// STATUS_MEMORY. Whether the stream took it, its owner finds out.
Status app_table_print(const AppTable *table, AppTableFormat format, FILE *stream);

// A row's values of a part as keys of a JSON object.
void app_table_record(const AppTablePart *part, int row, Record *record);

// A line for each column that has a help: its key and what it is.
void app_table_describe(const AppTable *table, FILE *stream);

#endif
