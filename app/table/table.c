// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/table/table.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"

enum { CELL_SIZE = 1024, ALL_DIGITS = 9, FEW_DIGITS = 4 };
enum { KEY_WIDTH = 22, HELP_WIDTH = 78 }; // of a description's columns

static const void *row_at(const AppTablePart *part, int row) {
  return (const char *)part->rows + (size_t)row * part->row_size;
}

static const char *text_at(const AppTableColumn *column, const void *row) {
  const char *text = *(const char *const *)((const char *)row + column->offset);
  return text ? text : "";
}

static long long integer_at(const AppTableColumn *column, const void *row) {
  return *(const long long *)((const char *)row + column->offset);
}

static double number_at(const AppTableColumn *column, const void *row) {
  return *(const double *)((const char *)row + column->offset);
}

// `digits`: significant, of numbers.
static void write_cell(const AppTableColumn *column, const void *row, int digits, char cell[CELL_SIZE]) {
  switch (column->kind) {
  case APP_TABLE_TEXT:
    snprintf(cell, CELL_SIZE, "%s", text_at(column, row));
    return;
  case APP_TABLE_INTEGER:
    snprintf(cell, CELL_SIZE, "%lld", integer_at(column, row));
    return;
  case APP_TABLE_NUMBER:
    cell[0] = 0;
    if (isfinite(number_at(column, row))) snprintf(cell, CELL_SIZE, "%.*g", digits, number_at(column, row));
    return;
  case APP_TABLE_COUNT:
    cell[0] = 0;
    if (isfinite(number_at(column, row))) snprintf(cell, CELL_SIZE, "%.0f", number_at(column, row));
    return;
  }
}

static void record_cell(const AppTableColumn *column, const void *row, Record *record) {
  switch (column->kind) {
  case APP_TABLE_TEXT:
    record_text(record, column->key, text_at(column, row));
    return;
  case APP_TABLE_INTEGER:
    record_integer(record, column->key, integer_at(column, row));
    return;
  case APP_TABLE_COUNT:
    record_whole(record, column->key, number_at(column, row));
    return;
  case APP_TABLE_NUMBER:
    record_number(record, column->key, number_at(column, row));
    return;
  }
}

void app_table_record(const AppTablePart *part, int row, Record *record) {
  for (int c = 0; c < part->column_count; c++) record_cell(&part->columns[c], row_at(part, row), record);
}

static Status print_json(const AppTable *table, int row, FILE *stream) {
  Record *record = record_new();
  if (!record) return status_no_memory("a row");
  for (int p = 0; p < table->part_count; p++) app_table_record(&table->parts[p], row, record);
  Status status = record_print_line(record, stream);
  record_destroy(record);
  return status;
}

// Quoted where RFC 4180 asks for it.
static void print_field(const char *text, FILE *stream) {
  if (!strpbrk(text, ",\"\n")) {
    fputs(text, stream);
    return;
  }
  putc('"', stream);
  for (const char *letter = text; *letter; letter++) {
    if (*letter == '"') putc('"', stream);
    putc(*letter, stream);
  }
  putc('"', stream);
}

// `row` −1: the keys.
static void print_csv(const AppTable *table, int row, FILE *stream) {
  bool is_first = true;
  for (int p = 0; p < table->part_count; p++)
    for (int c = 0; c < table->parts[p].column_count; c++, is_first = false) {
      const AppTablePart *part = &table->parts[p];
      char cell[CELL_SIZE];
      if (!is_first) putc(',', stream);
      if (row >= 0) write_cell(&part->columns[c], row_at(part, row), ALL_DIGITS, cell);
      print_field(row >= 0 ? cell : part->columns[c].key, stream);
    }
  putc('\n', stream);
}

// Of the letters, each of which may have several bytes.
static int width_of(const char *text) {
  int width = 0;
  for (; *text; text++) width += (*text & 0xC0) != 0x80;
  return width;
}

static void print_padded(const char *text, int width, bool is_left, FILE *stream) {
  int blanks = width - width_of(text);
  if (blanks < 0) blanks = 0;
  if (is_left)
    fprintf(stream, "%s%*s", text, blanks, "");
  else
    fprintf(stream, "%*s%s", blanks, "", text);
}

// Of a column whose head is shown.
static int column_width(const AppTable *table, const AppTablePart *part, const AppTableColumn *column) {
  int width = width_of(column->head);
  for (int r = 0; r < table->row_count; r++) {
    char cell[CELL_SIZE];
    write_cell(column, row_at(part, r), FEW_DIGITS, cell);
    if (width_of(cell) > width) width = width_of(cell);
  }
  return width;
}

// Texts to the left and numbers to the right; `row` −1: the heads. `widths` by column, all parts in a row.
static void print_line(const AppTable *table, const int *widths, bool is_markdown, int row, FILE *stream) {
  if (is_markdown) putc('|', stream);
  for (int p = 0; p < table->part_count; p++)
    for (int c = 0; c < table->parts[p].column_count; c++) {
      const AppTableColumn *column = &table->parts[p].columns[c];
      int width = *widths++;
      char cell[CELL_SIZE];
      if (!column->head) continue;
      if (row >= 0) write_cell(column, row_at(&table->parts[p], row), FEW_DIGITS, cell);
      if (is_markdown) putc(' ', stream);
      print_padded(row >= 0 ? cell : column->head, width, column->kind == APP_TABLE_TEXT, stream);
      fputs(is_markdown ? " |" : "  ", stream);
    }
  putc('\n', stream);
}

static void print_rule(const AppTable *table, FILE *stream) {
  putc('|', stream);
  for (int p = 0; p < table->part_count; p++)
    for (int c = 0; c < table->parts[p].column_count; c++) {
      const AppTableColumn *column = &table->parts[p].columns[c];
      if (column->head) fputs(column->kind == APP_TABLE_TEXT ? "---|" : "--:|", stream);
    }
  putc('\n', stream);
}

static Status print_aligned(const AppTable *table, bool is_markdown, FILE *stream) {
  int count = 0, at = 0;
  for (int p = 0; p < table->part_count; p++) count += table->parts[p].column_count;
  int *widths = memory_zeroed((size_t)count, sizeof *widths);
  if (!widths) return status_no_memory("a table");
  for (int p = 0; p < table->part_count; p++)
    for (int c = 0; c < table->parts[p].column_count; c++, at++) {
      const AppTablePart *part = &table->parts[p];
      if (part->columns[c].head) widths[at] = column_width(table, part, &part->columns[c]);
    }
  print_line(table, widths, is_markdown, -1, stream);
  if (is_markdown) print_rule(table, stream);
  for (int r = 0; r < table->row_count; r++) print_line(table, widths, is_markdown, r, stream);
  memory_free(widths);
  return STATUS_OK;
}

Status app_table_print(const AppTable *table, AppTableFormat format, FILE *stream) {
  if (format == APP_TABLE_PLAIN || format == APP_TABLE_MARKDOWN)
    return print_aligned(table, format == APP_TABLE_MARKDOWN, stream);
  if (format == APP_TABLE_CSV) print_csv(table, -1, stream);
  for (int r = 0; r < table->row_count; r++) {
    if (format == APP_TABLE_CSV)
      print_csv(table, r, stream);
    else
      TRY(print_json(table, r, stream));
  }
  return STATUS_OK;
}

// Words of a text on lines of at most HELP_WIDTH bytes (argp counts bytes), from the second line on behind
// the keys; `column` is where it begins.
static void print_wrapped(const char *text, int column, FILE *stream) {
  for (const char *word = text; *word; word += strspn(word, " ")) {
    int length = (int)strcspn(word, " ");
    bool is_first = word == text, fits = column + !is_first + length <= HELP_WIDTH;
    if (!is_first && !fits) fprintf(stream, "\n%*s", KEY_WIDTH + 3, "");
    if (!is_first && fits) fputc(' ', stream);
    fprintf(stream, "%.*s", length, word);
    column = fits ? column + !is_first + length : KEY_WIDTH + 3 + length;
    word += length;
  }
  fputc('\n', stream);
}

void app_table_describe(const AppTable *table, FILE *stream) {
  for (int p = 0; p < table->part_count; p++)
    for (int c = 0; c < table->parts[p].column_count; c++) {
      const AppTableColumn *column = &table->parts[p].columns[c];
      if (column->help)
        print_wrapped(column->help, fprintf(stream, "  %-*s ", KEY_WIDTH, column->key), stream);
    }
}
