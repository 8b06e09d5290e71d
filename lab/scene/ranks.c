// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/ranks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/sweep/child.h"
#include "base/files/file.h"
#include "base/files/record.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/ranks.h"

enum { PATH = 512 };
static const struct timespec PAUSE = {.tv_nsec = 20 * 1000 * 1000};

typedef struct Options {
  AppBenchOptions common;
  int counts[APP_BENCH_MAX_LIST], count_count;
  const char *scene_path;
} Options;

static const struct argp_option option_table[] = {
    {"ranks", 'n', "N,...", 0, "Numbers of processes (default: 1,2)", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'n':
    options->count_count = app_bench_options_counts(state, "ranks", text, RANKS_MOST, options->counts);
    return 0;
  case ARGP_KEY_ARG:
    if (options->scene_path) argp_error(state, "one scene at a time; '%s' is the second", text);
    options->scene_path = text;
    return 0;
  case ARGP_KEY_END:
    if (!options->scene_path) argp_error(state, "name a scene file");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *scene;
  long long ranks, steps, iterations;
  double vertices, elements, entries, peak, cpu_least, cpu_most, work, waiting, calls, bytes, forces, solve,
      wall;
} Row;

static const AppBenchColumn columns[] = {
    {"scene", APP_BENCH_TEXT, offsetof(Row, scene), NULL, "file"},
    {"ranks", APP_BENCH_INTEGER, offsetof(Row, ranks), "ranks", "processes"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"linear_iterations", APP_BENCH_INTEGER, offsetof(Row, iterations), "iterations",
     "of the linear solver, in all"},
    {"vertices", APP_BENCH_COUNT, offsetof(Row, vertices), "vertices", "most of any rank"},
    {"elements", APP_BENCH_COUNT, offsetof(Row, elements), "elements", "most of any rank"},
    {"matrix_entries", APP_BENCH_COUNT, offsetof(Row, entries), "entries",
     "of the matrix that a rank adds to, most of any"},
    {"peak_rss_bytes", APP_BENCH_COUNT, offsetof(Row, peak), "peak bytes", "memory, most of any rank"},
    {"cpu_least_s", APP_BENCH_NUMBER, offsetof(Row, cpu_least), NULL,
     "processor time, least of any rank; ranks that wait may use some"},
    {"cpu_s", APP_BENCH_NUMBER, offsetof(Row, cpu_most), "cpu s", "processor time, most of any rank"},
    {"work_s", APP_BENCH_NUMBER, offsetof(Row, work), "work s",
     "processor time outside of MPI, most of any rank: without waiting"},
    {"forces_s", APP_BENCH_NUMBER, offsetof(Row, forces), NULL, "wall time of forces, most of any rank"},
    {"solve_s", APP_BENCH_NUMBER, offsetof(Row, solve), NULL, "wall time of solutions, most of any rank"},
    {"waiting_s", APP_BENCH_NUMBER, offsetof(Row, waiting), "waiting s",
     "wall time in sums and exchanges but PETSc's, most of any rank"},
    {"calls", APP_BENCH_COUNT, offsetof(Row, calls), "calls", "sums, exchanges and decisions but PETSc's"},
    {"bytes", APP_BENCH_COUNT, offsetof(Row, bytes), "bytes", "that a rank gave to those, most of any rank"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "whole run"},
};
static const AppBenchReport report = {"ranks", columns, sizeof columns / sizeof *columns, sizeof(Row), true};

// NaN: it is not there.
static double number_of(const Record *record, const char *child, const char *key) {
  const Record *from = child ? record_find(record, child) : record;
  return from ? record_find_number(from, key) : NAN;
}

static double most_of(const Record *summary, const char *key) {
  const Record *spread = record_find(summary, "ranks");
  return spread ? number_of(spread, key, "most") : NAN;
}

static void fill_row(const Record *summary, Row *row) {
  const Record *spread = record_find(summary, "ranks");
  row->steps = (long long)number_of(summary, NULL, "steps");
  row->iterations = (long long)number_of(summary, "counters", "linear_iterations");
  row->wall = number_of(summary, NULL, "wall_s");
  row->vertices = number_of(summary, NULL, "vertices");
  row->elements = number_of(summary, NULL, "tetrahedra");
  row->peak = number_of(summary, NULL, "peak_rss_bytes");
  row->cpu_least = row->cpu_most = row->work = number_of(summary, NULL, "cpu_s");
  row->forces = number_of(summary, "phases", "forces");
  row->solve = number_of(summary, "phases", "solve");
  row->entries = most_of(summary, "matrix_entries");
  row->waiting = most_of(summary, "waiting_s");
  row->calls = most_of(summary, "calls");
  row->bytes = most_of(summary, "bytes_given");
  if (!spread) return;
  row->vertices = most_of(summary, "vertices");
  row->elements = most_of(summary, "elements");
  row->peak = most_of(summary, "peak_rss_bytes");
  row->cpu_least = number_of(spread, "cpu_s", "least");
  row->cpu_most = most_of(summary, "cpu_s");
  row->work = most_of(summary, "work_s");
  row->forces = most_of(summary, "forces_s");
  row->solve = most_of(summary, "solve_s");
}

static Status run_child(const char *scene_path, int count, const char *directory) {
  char number[16], log[PATH + 16];
  snprintf(number, sizeof number, "%d", count);
  snprintf(log, sizeof log, "%s/log", directory);
  char *words[] = {(char[]){"tetlap"},
                   (char[]){"run"},
                   (char *)scene_path,
                   (char[]){"-q"},
                   (char[]){"-o"},
                   (char *)directory,
                   (char[]){"-t"},
                   (char[]){"1"},
                   (char[]){"--ranks"},
                   number,
                   NULL};
  pid_t child;
  int code;
  TRY(app_sweep_child_start(words, log, &child));
  while (!app_sweep_child_has_ended(child, &code)) nanosleep(&PAUSE, NULL);
  if (code == 0) return STATUS_OK;
  char *text = NULL;
  size_t size;
  Status read = file_read(log, &text, &size);
  Status status = status_fail(STATUS_SOLVER, "%d ranks: exit code %d: %.800s", count, code, read ? "" : text);
  memory_free(text);
  return status;
}

static Status read_summary(const char *directory, Row *row) {
  char path[PATH + 16];
  Record *summary;
  snprintf(path, sizeof path, "%s/summary.json", directory);
  TRY(record_read(&summary, path));
  fill_row(summary, row);
  record_destroy(summary);
  return STATUS_OK;
}

static Status measure(const Options *options, const char *folder, int count, Row *row) {
  char directory[PATH];
  snprintf(directory, sizeof directory, "%s/%d", folder, count);
  TRY(file_make_directories(directory));
  *row = (Row){.scene = options->scene_path, .ranks = count};
  TRY(run_child(options->scene_path, count, directory));
  return read_summary(directory, row);
}

static Status run(const Options *options) {
  Row rows[APP_BENCH_MAX_LIST];
  char folder[] = "/tmp/tetlap_ranks_XXXXXX", command[64];
  if (!mkdtemp(folder)) return status_fail(STATUS_IO, "%s: cannot be made", folder);
  Status status = STATUS_OK;
  for (int k = 0; k < options->count_count && !status; k++) {
    log_progress("%d ranks", options->counts[k]);
    status = measure(options, folder, options->counts[k], &rows[k]);
    log_progress_end();
  }
  if (!status) status = app_bench_report_print(&report, &options->common, rows, options->count_count);
  snprintf(command, sizeof command, "rm -rf %s", folder);
  if (system(command) != 0) log_warning("%s: is left", folder);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "SCENE",
    .doc = "Run SCENE on several numbers of processes, one after the other (tetlap-mpi, docs/parallel.md).",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 1}, .counts = {1, 2}, .count_count = 2};
  app_bench_command_read(&lab_ranks, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_ranks = {.name = "ranks",
                              .help = "work, memory and balance of a run over processes",
                              .argp = &argp,
                              .run = run_command,
                              .rows = &report,
                              .describe_rows = app_bench_command_rows};
