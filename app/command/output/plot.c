// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/output/plot.h"

#include <string.h>
#include <sys/stat.h>

#include "app/cli/argument.h"
#include "app/plot/gnuplot.h"
#include "app/plot/plot.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"

enum { KEY_QUANTITY = 256, MAX_SOURCES = 2 };

typedef struct Options {
  const char *sources[MAX_SOURCES];
  int source_count;
  const char *picture, *quantities;
  bool is_quiet;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0,
     "The picture: FILE.svg, FILE.pdf or FILE.png; its script is FILE with .gp appended", 0},
    {"quantity", KEY_QUANTITY, "NAME,...", 0, "Of a frontier: only V, V+grad or force", 0},
    {"quiet", 'q', NULL, 0, "Say errors only", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->picture = text;
    return 0;
  case KEY_QUANTITY:
    options->quantities = app_argument_words(state, "quantity", text, "V,force");
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->source_count == MAX_SOURCES)
      argp_error(state, "'%s' is one argument too many: give one run or two", text);
    options->sources[options->source_count++] = text;
    return 0;
  case ARGP_KEY_END:
    if (options->source_count == 0)
      argp_error(state, "name the directory of a run, of two, or a pareto.json");
    if (!options->picture) argp_error(state, "name the picture, as in -o forces.svg");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static const char *last_name(const char *directory) {
  const char *slash = strrchr(directory, '/');
  return slash && slash[1] ? slash + 1 : directory;
}

// What tells two runs apart: their overlap models, else the names of their directories, or their whole paths.
static void label(const AppReportRun *runs, int count, const char **labels, AppModelName *models) {
  for (int r = 0; r < count; r++) labels[r] = last_name(runs[r].directory);
  if (count < 2) return;
  if (strcmp(labels[0], labels[1]) == 0) labels[0] = runs[0].directory, labels[1] = runs[1].directory;
  if (app_report_run_models(runs, count, models)) labels[0] = models[0], labels[1] = models[1];
}

static Status write_history(FILE *script, const Options *options) {
  AppReportRun runs[MAX_SOURCES] = {{0}};
  const char *labels[MAX_SOURCES];
  AppModelName models[MAX_SOURCES];
  Status status = STATUS_OK;
  for (int r = 0; !status && r < options->source_count; r++)
    status = app_report_run_read(&runs[r], options->sources[r], 1);
  if (!status) {
    label(runs, options->source_count, labels, models);
    status = app_plot_history(script, options->picture, runs, options->source_count, labels);
  }
  for (int r = 0; r < options->source_count; r++) app_report_run_destroy(&runs[r]);
  return status;
}

static Status write_frontier(FILE *script, const Options *options) {
  if (options->source_count > 1) return status_fail(STATUS_USAGE, "a frontier is plotted of one file");
  Record *pareto;
  TRY(record_read(&pareto, options->sources[0]));
  Status status = app_plot_frontier(script, options->picture, pareto, options->quantities);
  record_destroy(pareto);
  return status == STATUS_INPUT ? status_prefix(status, "%s", options->sources[0]) : status;
}

// A directory, also one that is not there; a name that ends in .json is that of a frontier.
static bool is_run_named(const char *source) {
  struct stat info;
  if (stat(source, &info) == 0) return S_ISDIR(info.st_mode);
  size_t length = strlen(source), ending = strlen(".json");
  return length < ending || strcmp(source + length - ending, ".json") != 0;
}

static Status plot(const Options *options, const char *path) {
  bool is_run = is_run_named(options->sources[0]);
  if (is_run && options->quantities)
    return status_fail(STATUS_USAGE,
                       "--quantity chooses from a frontier, and %s is a run; leave it out, or name a "
                       "pareto.json",
                       options->sources[0]);
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = is_run ? write_history(writer.stream, options) : write_frontier(writer.stream, options);
  if (status) {
    file_abandon(&writer);
    return status;
  }
  TRY(file_commit(&writer));
  TRY(app_gnuplot_run(path, options->picture));
  log_info("wrote %s and its script %s", options->picture, path);
  return STATUS_OK;
}

static const struct argp argp = {
    option_table,
    parse,
    "DIR [DIR] | pareto.json",
    "Draw a figure for a paper: the forces, energies and steps of one or two runs, or the frontier of error "
    "and time.\vThe gnuplot script that drew it is kept beside it and holds the data.",
    NULL,
    NULL,
    NULL};

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  if (argp_parse(&argp, argument_count, arguments, 0, NULL, &options)) return status_exit_code(STATUS_USAGE);
  if (options.is_quiet) log_set_level(LOG_ERROR);
  size_t size = strlen(options.picture) + 4;
  char *script = memory_zeroed(size, 1);
  Status status = script ? STATUS_OK : status_no_memory("a file name");
  if (!status) {
    snprintf(script, size, "%s.gp", options.picture);
    status = plot(&options, script);
  }
  memory_free(script);
  return app_cli_command_end(status);
}

const AppCommand app_command_plot = {.name = "plot",
                                     .help = "draw one or two runs, or a frontier, for a paper",
                                     .argp = &argp,
                                     .run = run_command};
