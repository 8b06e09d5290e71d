// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <string.h>

#include "app/cli/parse.h"
#include "app/plot/gnuplot.h"
#include "app/plot/plot.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"

enum { MAX_SOURCES = 2 };

typedef struct Options {
  const char *sources[MAX_SOURCES];
  int source_count;
  const char *picture;
  bool is_quiet;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "FILE",
     "The picture: FILE.svg, FILE.pdf or FILE.png; its script is FILE with .gp appended", 0, CLI_TEXT,
     CLI_TO(Options, picture)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

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

static Status plot(const Options *options, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = write_history(writer.stream, options);
  if (status) {
    file_abandon(&writer);
    return status;
  }
  TRY(file_commit(&writer));
  TRY(app_gnuplot_run(path, options->picture));
  log_info("wrote %s and its script %s", options->picture, path);
  return STATUS_OK;
}

static void check(struct argp_state *state, void *options) {
  if (!((const Options *)options)->picture) argp_error(state, "name the picture, as in -o forces.svg");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_plot, argument_count, arguments, &options);
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

const AppCommand app_command_plot = {
    .name = "plot",
    .help = "draw one or two runs for a paper",
    .options = option_table,
    .arguments = &(const AppArguments){"DIR [DIR]", offsetof(Options, sources), MAX_SOURCES,
                                       offsetof(Options, source_count),
                                       .missing = "name the directory of a run, or of two",
                                       .excess = "'%s' is one argument too many: give one run or two"},
    .doc = "Draw a figure for a paper: the forces, energies and steps of one or two runs.\vThe gnuplot "
           "script that "
           "drew it is kept beside it and holds the data.",
    .check = check,
    .run = run_command};
