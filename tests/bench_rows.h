// SPDX-License-Identifier: GPL-3.0-or-later
// Rows that benches print as JSON: that they carry what is promised.
#ifndef TETLAP_TESTS_BENCH_ROWS_H
#define TETLAP_TESTS_BENCH_ROWS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "base/text.h"
#include "suite.h"

enum { OUTPUT_SIZE = 1 << 16 };

// What `program` with these arguments prints; its exit code.
static int run_bench(const char *program, const char *arguments, char output[OUTPUT_SIZE]) {
  char command[1024];
  snprintf(command, sizeof command, "cd '%s' && %s 2>/dev/null %s", TETLAP_SOURCE_DIR, program, arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, OUTPUT_SIZE - 1, pipe)] = 0;
  int ended = pclose(pipe);
  return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
}

// Where the value of a key begins in a row of JSON; fails if the row lacks it.
static const char *value_of(const char *row, const char *key) {
  char quoted[TEXT_MAX_WORD + 8];
  snprintf(quoted, sizeof quoted, "\"%s\":", key);
  const char *found = strstr(row, quoted);
  ck_assert_msg(found != NULL, "no %s in %s", quoted, row);
  return found + strlen(quoted);
}

// Infinite for null where a rate by processor time may be so: a bench this short can fall between two ticks
// of that clock.
static double number_of(const char *row, const char *key) {
  char *end;
  const char *value = value_of(row, key);
  if (strstr(key, "cpu") && strncmp(value, "null", 4) == 0) return INFINITY;
  double number = strtod(value, &end);
  ck_assert_msg(end != value, "%s is no number in %s", key, row);
  return number;
}

// A bench at a tiny size, the keys that BENCHMARKS.md promises, and those of them that must be positive.
typedef struct Promise {
  const char *arguments;
  int rows;                    // 0: some
  const char *keys, *positive; // separated by spaces
} Promise;

// What is counted is written without a decimal point.
static void check_counts(const char *row) {
  static const char keys[] = "vertices unknowns steps threads newton_iterations linear_iterations set_ups "
                             "factor_entries peak_bytes";
  char key[TEXT_MAX_WORD], quoted[TEXT_MAX_WORD + 4];
  for (const char *rest = text_next(keys, key); rest; rest = text_next(rest, key)) {
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    const char *at = strstr(row, quoted);
    if (!at) continue;
    at += strlen(quoted);
    at += strncmp(at, "null", 4) == 0 ? 4 : strspn(at, "-0123456789");
    ck_assert_msg(*at == ',' || *at == '}', "%s is no whole number in %s", key, row);
  }
}

static void check_row(const char *row, const Promise *promise) {
  char key[TEXT_MAX_WORD];
  ck_assert_int_eq(row[0], '{');
  ck_assert_int_eq(row[strlen(row) - 1], '}');
  for (const char *rest = text_next(promise->keys, key); rest; rest = text_next(rest, key))
    value_of(row, key);
  for (const char *rest = text_next(promise->positive, key); rest; rest = text_next(rest, key))
    ck_assert_msg(number_of(row, key) > 0, "%s is not positive in %s", key, row);
  check_counts(row);
  value_of(row, "processor");
  value_of(row, "simd");
  value_of(row, "versions");
  ck_assert_double_ge(number_of(row, "repeats"), 1);
}

static void check_promise(const char *program, const Promise *promise) {
  static char output[OUTPUT_SIZE];
  char arguments[512];
  snprintf(arguments, sizeof arguments, "%s --json", promise->arguments);
  ck_assert_int_eq(run_bench(program, arguments, output), 0);
  int rows = 0;
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n"), rows++) check_row(row, promise);
  ck_assert_int_gt(rows, 0);
  if (promise->rows) ck_assert_int_eq(rows, promise->rows);
}

#endif
