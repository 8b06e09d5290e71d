// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/report.h"

#include "app/cli/versions.h"
#include "base/machine/cpu.h"

// What every row has.
typedef struct Common {
  const char *bench, *processor, *simd, *versions;
  long long threads, repeats;
} Common;

static const AppTableColumn first_columns[] = {
    {"bench", APP_TABLE_TEXT, offsetof(Common, bench), NULL, "the bench's name"},
};
static const AppTableColumn last_columns[] = {
    {"threads", APP_TABLE_INTEGER, offsetof(Common, threads), NULL, "threads"},
    {"repeats", APP_TABLE_INTEGER, offsetof(Common, repeats), NULL, "rounds, of which the median is printed"},
    {"processor", APP_TABLE_TEXT, offsetof(Common, processor), NULL, "the processor's model name"},
    {"simd", APP_TABLE_TEXT, offsetof(Common, simd), NULL, "widest vectors that kernels can use here"},
    {"versions", APP_TABLE_TEXT, offsetof(Common, versions), NULL, "of the program, compiler and libraries"},
};
enum { LAST_COUNT = sizeof last_columns / sizeof *last_columns, PART_COUNT = 3 };

static void fill_parts(const AppBenchReport *report, const Common *common, const void *rows,
                       AppTablePart parts[PART_COUNT]) {
  int left_out = report->has_own_threads;
  parts[0] = (AppTablePart){first_columns, 1, common, 0};
  parts[1] = (AppTablePart){report->columns, report->column_count, rows, report->row_size};
  parts[2] = (AppTablePart){last_columns + left_out, LAST_COUNT - left_out, common, 0};
}

static void print_head(const AppBenchReport *report, const Common *common) {
  printf("%s: %s, %s, ", common->bench, common->processor, common->simd);
  if (!report->has_own_threads) printf("threads: %lld, ", common->threads);
  printf("rounds: %lld\n%s\n", common->repeats, common->versions);
}

Status app_bench_report_print(const AppBenchReport *report, const AppBenchOptions *options, const void *rows,
                              int row_count) {
  AppTablePart parts[PART_COUNT];
  Common common = {.bench = report->bench,
                   .processor = cpu_name(),
                   .simd = app_versions_simd(),
                   .versions = app_versions_line(),
                   .threads = options->threads,
                   .repeats = options->repeats};
  fill_parts(report, &common, rows, parts);
  if (options->format == APP_TABLE_PLAIN) print_head(report, &common);
  TRY(app_table_print(&(AppTable){parts, PART_COUNT, row_count}, options->format, stdout));
  return fflush(stdout) == 0 ? STATUS_OK : status_fail(STATUS_IO, "standard output cannot be written");
}

char *app_bench_report_describe(const void *rows) {
  char *help = NULL;
  size_t size;
  FILE *stream = open_memstream(&help, &size);
  if (!stream) return NULL;
  AppTablePart parts[PART_COUNT];
  fill_parts(rows, NULL, NULL, parts);
  fputs("Columns of a row (JSON, CSV):\n", stream);
  app_table_describe(&(AppTable){parts, PART_COUNT, 0}, stream);
  fclose(stream);
  return help;
}
