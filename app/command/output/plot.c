// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <string.h>

#include "app/cli/argument.h"
#include "app/cli/parse.h"
#include "app/plot/along.h"
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
  AppPlotAlong along;
  bool is_along, has_within, is_quiet;
} Options;

static void read_path(struct argp_state *state, void *member, char *text) {
  AppPlotPath *path = member;
  double within = path->within; // given before, perhaps
  bool is_one = app_plot_path_read(path, text);
  path->within = within;
  if (!is_one)
    argp_error(
        state,
        "--along is '%s'; give x, y or z, radius:AXIS (of an axis through the origin), "
        "radius:AXIS:X,Y,Z (through a point), the ends of a line, as in 0,0,0:0,0,1, or line:NAME, a line of "
        "the scene (bodies[].lines)",
        text);
}

static void read_times(struct argp_state *state, void *member, char *text) {
  AppPlotAlong *along = member;
  const char *words[APP_PLOT_MAX_TIMES];
  along->time_count = app_argument_list(state, "at", text, "0.5,1", APP_PLOT_MAX_TIMES, words);
  for (int k = 0; k < along->time_count; k++)
    along->times[k] = app_argument_number(state, "at", words[k], -1e300, 1e300);
}

static const AppOption option_table[] = {
    {"output", 'o', "FILE",
     "The picture: FILE.svg, FILE.pdf or FILE.png; its script is FILE with .gp appended", 0, CLI_TEXT,
     CLI_TO(Options, picture)},
    {"along", 0, "PATH",
     "Draw a quantity of the frames at the vertices of surfaces over x, y or z, over the distance from an "
     "axis (radius:z, or radius:z:X,Y,Z through a point), or where a line runs through elements "
     "(X,Y,Z:X,Y,Z), at places of that frame; or along line:NAME of bodies[].lines, whose points move with "
     "the body",
     1, CLI_OWN, CLI_TO(Options, along.path), .read = read_path, .mark_offset = offsetof(Options, is_along)},
    {"of", 0, "ARRAY[:COMPONENT]",
     "What --along draws, as contact_pressure or stress:zz; of a vector without x, y or z its length", 1,
     CLI_TEXT, CLI_TO(Options, along.quantity)},
    {"at", 0, "TIME[,TIME]", "Of --along: the frames next to these times, in s (default: the last)", 1,
     CLI_OWN, CLI_TO(Options, along), .read = read_times},
    {"body", 0, "NAME", "Of --along: one body alone", 1, CLI_TEXT, CLI_TO(Options, along.body)},
    {"within", 0, "DISTANCE",
     "Of --along and a line: in place of elements the vertices of surfaces no farther from it, in m", 1,
     CLI_POSITIVE, CLI_TO(Options, along.path.within), .mark_offset = offsetof(Options, has_within)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static const char *last_name(const char *directory) {
  const char *slash = strrchr(directory, '/');
  return slash && slash[1] ? slash + 1 : directory;
}

// What distinguishes two runs: their overlap models, else the names of their directories, or their whole
// paths.
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

static Status write_along(FILE *script, const Options *options) {
  const char *labels[MAX_SOURCES];
  for (int r = 0; r < options->source_count; r++) labels[r] = last_name(options->sources[r]);
  if (options->source_count > 1 && strcmp(labels[0], labels[1]) == 0)
    labels[0] = options->sources[0], labels[1] = options->sources[1];
  return app_plot_along(script, options->picture, &options->along, options->sources, options->source_count,
                        labels);
}

static Status plot(const Options *options, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status =
      options->is_along ? write_along(writer.stream, options) : write_history(writer.stream, options);
  if (status) {
    file_abandon(&writer);
    return status;
  }
  TRY(file_commit(&writer));
  TRY(app_gnuplot_run(path, options->picture));
  log_info("wrote %s and its script %s", options->picture, path);
  return STATUS_OK;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  const AppPlotAlong *along = &options->along;
  if (!options->picture) argp_error(state, "name the picture, as in -o forces.svg");
  if (options->is_along && !along->quantity)
    argp_error(state, "--along needs what it draws, as in --of contact_pressure");
  if (!options->is_along && (along->quantity || along->body || along->time_count || options->has_within))
    argp_error(state, "--of, --at, --body and --within belong to --along; add it, as in --along x");
  if (along->path.kind == APP_PLOT_NAMED && along->body)
    argp_error(state, "a line of the scene is of one body; leave --body out");
  if (options->has_within && along->path.kind != APP_PLOT_LINE)
    argp_error(state, "--within is of a line; leave it out, or give --along X,Y,Z:X,Y,Z");
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
    .doc =
        "Draw a figure for a paper: the forces, energies and steps of one or two runs, or a quantity of "
        "their frames along a path.\vThe gnuplot script that drew it is kept beside it and holds the data.",
    .check = check,
    .run = run_command};
