// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/report.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/versions.h"
#include "base/cpu.h"

enum { CELL_SIZE = 512 };

// What every row tells.
typedef struct Common {
  const char *bench, *processor, *simd, *versions;
  long long threads, repeats;
} Common;

static const AppBenchColumn first_columns[] = {
    {"bench", APP_BENCH_TEXT, offsetof(Common, bench), NULL, "the bench's name"},
};
static const AppBenchColumn thread_columns[] = {
    {"threads", APP_BENCH_INTEGER, offsetof(Common, threads), NULL, "threads"},
};
static const AppBenchColumn last_columns[] = {
    {"repeats", APP_BENCH_INTEGER, offsetof(Common, repeats), NULL, "rounds, of which the median is printed"},
    {"processor", APP_BENCH_TEXT, offsetof(Common, processor), NULL, "the processor's model name"},
    {"simd", APP_BENCH_TEXT, offsetof(Common, simd), NULL, "widest vectors that kernels can use here"},
    {"versions", APP_BENCH_TEXT, offsetof(Common, versions), NULL, "of the program, compiler and libraries"},
};

// A row's cells in four groups: common, own, common.
typedef struct Group {
  const AppBenchColumn *columns;
  int count;
  const void *row;
} Group;

enum { GROUP_COUNT = 4 };
enum { KEY_WIDTH = 22, HELP_WIDTH = 78 }; // of a help text's columns

static void group(const AppBenchReport *report, const Common *common, const void *row,
                  Group groups[GROUP_COUNT]) {
  groups[0] = (Group){first_columns, sizeof first_columns / sizeof *first_columns, common};
  groups[1] = (Group){report->columns, report->column_count, row};
  groups[2] = (Group){thread_columns, report->has_own_threads ? 0 : 1, common};
  groups[3] = (Group){last_columns, sizeof last_columns / sizeof *last_columns, common};
}

static const char *text_at(const AppBenchColumn *column, const void *row) {
  const char *text = *(const char *const *)((const char *)row + column->offset);
  return text ? text : "";
}

static long long integer_at(const AppBenchColumn *column, const void *row) {
  return *(const long long *)((const char *)row + column->offset);
}

static double number_at(const AppBenchColumn *column, const void *row) {
  return *(const double *)((const char *)row + column->offset);
}

// `digits`: significant, of numbers.
static void write_cell(const AppBenchColumn *column, const void *row, int digits, char cell[CELL_SIZE]) {
  switch (column->kind) {
  case APP_BENCH_TEXT:
    snprintf(cell, CELL_SIZE, "%s", text_at(column, row));
    return;
  case APP_BENCH_INTEGER:
    snprintf(cell, CELL_SIZE, "%lld", integer_at(column, row));
    return;
  case APP_BENCH_NUMBER:
  case APP_BENCH_COUNT:
    cell[0] = 0;
    if (!isnan(number_at(column, row))) snprintf(cell, CELL_SIZE, "%.*g", digits, number_at(column, row));
    return;
  }
}

static void record_cell(Record *record, const AppBenchColumn *column, const void *row) {
  switch (column->kind) {
  case APP_BENCH_TEXT:
    record_text(record, column->key, text_at(column, row));
    return;
  case APP_BENCH_INTEGER:
    record_integer(record, column->key, integer_at(column, row));
    return;
  case APP_BENCH_COUNT:
    record_whole(record, column->key, number_at(column, row));
    return;
  case APP_BENCH_NUMBER:
    record_number(record, column->key, number_at(column, row));
    return;
  }
}

static Status print_json(FILE *stream, const Group groups[GROUP_COUNT]) {
  Record *record = record_new();
  if (!record) return status_no_memory("a row");
  for (int g = 0; g < GROUP_COUNT; g++)
    for (int c = 0; c < groups[g].count; c++) record_cell(record, &groups[g].columns[c], groups[g].row);
  Status status = record_print_line(record, stream);
  record_destroy(record);
  return status;
}

// Quoted where RFC 4180 asks for it.
static void print_field(FILE *stream, const char *text) {
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

// The keys if `is_head`, else the values.
static void print_csv(FILE *stream, const Group groups[GROUP_COUNT], bool is_head) {
  bool is_first = true;
  for (int g = 0; g < GROUP_COUNT; g++)
    for (int c = 0; c < groups[g].count; c++, is_first = false) {
      char cell[CELL_SIZE];
      if (!is_first) putc(',', stream);
      write_cell(&groups[g].columns[c], groups[g].row, 9, cell);
      print_field(stream, is_head ? groups[g].columns[c].key : cell);
    }
  putc('\n', stream);
}

static int width_of(const AppBenchReport *report, const AppBenchColumn *column, const char *rows,
                    int row_count) {
  size_t width = strlen(column->head);
  for (int r = 0; r < row_count; r++) {
    char cell[CELL_SIZE];
    write_cell(column, rows + (size_t)r * report->row_size, 4, cell);
    if (strlen(cell) > width) width = strlen(cell);
  }
  return (int)width;
}

// Columns of a width of their own, texts to the left and numbers to the right; `row` NULL: the heads.
static void print_line(const AppBenchReport *report, const int *widths, bool is_markdown, const void *row) {
  if (is_markdown) putchar('|');
  for (int c = 0; c < report->column_count; c++) {
    const AppBenchColumn *column = &report->columns[c];
    char cell[CELL_SIZE];
    if (!column->head) continue;
    if (row)
      write_cell(column, row, 4, cell);
    else
      snprintf(cell, sizeof cell, "%s", column->head);
    int width = column->kind == APP_BENCH_TEXT ? -widths[c] : widths[c];
    printf(is_markdown ? " %*s |" : "%*s  ", width, cell);
  }
  putchar('\n');
}

static void print_rule(const AppBenchReport *report) {
  putchar('|');
  for (int c = 0; c < report->column_count; c++)
    if (report->columns[c].head) fputs(report->columns[c].kind == APP_BENCH_TEXT ? "---|" : "--:|", stdout);
  putchar('\n');
}

static void print_head(const AppBenchReport *report, const Common *common) {
  printf("%s: %s, %s, ", common->bench, common->processor, common->simd);
  if (!report->has_own_threads) printf("threads: %lld, ", common->threads);
  printf("rounds: %lld\n%s\n", common->repeats, common->versions);
}

static void print_table(const AppBenchReport *report, const Common *common, bool is_markdown,
                        const char *rows, int row_count) {
  enum { MAX_COLUMNS = 64 };
  int widths[MAX_COLUMNS];
  for (int c = 0; c < report->column_count; c++)
    widths[c] = report->columns[c].head ? width_of(report, &report->columns[c], rows, row_count) : 0;
  if (!is_markdown) print_head(report, common);
  print_line(report, widths, is_markdown, NULL);
  if (is_markdown) print_rule(report);
  for (int r = 0; r < row_count; r++)
    print_line(report, widths, is_markdown, rows + (size_t)r * report->row_size);
}

static Status print_rows(const AppBenchReport *report, const Common *common, AppBenchFormat format,
                         const char *rows, int row_count) {
  if (format == APP_BENCH_FORMAT_TABLE || format == APP_BENCH_FORMAT_MARKDOWN) {
    print_table(report, common, format == APP_BENCH_FORMAT_MARKDOWN, rows, row_count);
    return STATUS_OK;
  }
  for (int r = 0; r < row_count; r++) {
    Group groups[GROUP_COUNT];
    group(report, common, rows + (size_t)r * report->row_size, groups);
    if (format == APP_BENCH_FORMAT_JSON) {
      TRY(print_json(stdout, groups));
      continue;
    }
    if (r == 0) print_csv(stdout, groups, true);
    print_csv(stdout, groups, false);
  }
  return STATUS_OK;
}

static Common common_of(const AppBenchReport *report, const AppBenchOptions *options) {
  return (Common){.bench = report->bench,
                  .processor = cpu_name(),
                  .simd = app_versions_simd(),
                  .versions = app_versions_line(),
                  .threads = options->threads,
                  .repeats = options->repeats};
}

Status app_bench_report_print(const AppBenchReport *report, const AppBenchOptions *options, const void *rows,
                              int row_count) {
  Common common = common_of(report, options);
  TRY(print_rows(report, &common, options->format, rows, row_count));
  return fflush(stdout) == 0 ? STATUS_OK : status_fail(STATUS_IO, "standard output cannot be written");
}

void app_bench_report_write_csv(const AppBenchReport *report, const AppBenchOptions *options,
                                const void *rows, int row_count, FILE *stream) {
  Common common = common_of(report, options);
  Group groups[GROUP_COUNT];
  group(report, &common, rows, groups);
  print_csv(stream, groups, true);
  for (int r = 0; r < row_count; r++) {
    group(report, &common, (const char *)rows + (size_t)r * report->row_size, groups);
    print_csv(stream, groups, false);
  }
}

void app_bench_report_record(const AppBenchReport *report, const void *row, Record *record) {
  for (int c = 0; c < report->column_count; c++) record_cell(record, &report->columns[c], row);
}

// Words of a text on lines of at most `width` bytes (argp counts bytes), from the second line on behind
// `indent` blanks; `column` is where it begins.
static void print_wrapped(FILE *stream, const char *text, int column, int indent, int width) {
  for (const char *word = text; *word; word += strspn(word, " ")) {
    int length = (int)strcspn(word, " ");
    bool is_first = word == text, fits = column + !is_first + length <= width;
    if (!is_first && !fits) fprintf(stream, "\n%*s", indent, "");
    if (!is_first && fits) fputc(' ', stream);
    fprintf(stream, "%.*s", length, word);
    column = fits ? column + !is_first + length : indent + length;
    word += length;
  }
  fputc('\n', stream);
}

char *app_bench_report_help(const AppBenchReport *report, int argp_key, const char *text) {
  if (argp_key != ARGP_KEY_HELP_POST_DOC) return (char *)(uintptr_t)text; // argp's own way: it is not changed
  char *help = NULL;
  size_t size;
  FILE *stream = open_memstream(&help, &size);
  if (!stream) return NULL;
  Group groups[GROUP_COUNT];
  group(report, NULL, NULL, groups);
  fputs("Columns of a row (JSON, CSV):\n", stream);
  for (int g = 0; g < GROUP_COUNT; g++)
    for (int c = 0; c < groups[g].count; c++)
      print_wrapped(stream, groups[g].columns[c].help,
                    fprintf(stream, "  %-*s ", KEY_WIDTH, groups[g].columns[c].key), KEY_WIDTH + 3,
                    HELP_WIDTH);
  fclose(stream);
  return help;
}
