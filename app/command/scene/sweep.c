// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/job/job.h"
#include "app/sweep/child.h"
#include "app/sweep/crew.h"
#include "app/sweep/table.h"
#include "base/log.h"
#include "base/memory.h"

typedef struct Options {
  const char *scene_path, *directory, *overlap;
  const char *overrides[APP_MAX_OVERRIDES], *axes[APP_SWEEP_MAX_AXES];
  int override_count, axis_count;
  int jobs, threads; // 0: by what the machine has
  int repeats;
  bool again, is_json, is_markdown, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"vary", 'V', "KEY=VALUES",
     "Take these values of a key: LOW..HIGH:COUNT, LOW..HIGH:COUNT,log or A,B,C; may be repeated: every "
     "value with every other; 'KEY=VALUES with KEY=VALUES': both change together",
     1, CLI_REPEATED, CLI_TO(Options, axes), .most = APP_SWEEP_MAX_AXES, .example = "--vary",
     .count_offset = offsetof(Options, axis_count)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene in all runs; may be repeated", 1, CLI_REPEATED,
     CLI_TO(Options, overrides), .most = APP_MAX_OVERRIDES - APP_SWEEP_MAX_AXES, .example = "--set",
     .count_offset = offsetof(Options, override_count)},
    {"overlap", 'm', "NAME", "Take this overlap model instead of the scene's", 1, CLI_TEXT,
     CLI_TO(Options, overlap)},
    {"output", 'o', "DIR", "Write into DIR (default: out/ and the scene's name, -sweep)", 1, CLI_TEXT,
     CLI_TO(Options, directory)},
    {"jobs", 'J', "N", "Runs at once (default: one a core)", 1, CLI_INTEGER, CLI_TO(Options, jobs), 1,
     APP_SWEEP_MAX_JOBS},
    {"threads", 't', "N", "Threads of each run (default: the cores shared among the runs)", 1, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"repeat", 'r', "N", "Run each N times, in turns, for times: the table has medians (with --jobs 1)", 1,
     CLI_INTEGER, CLI_TO(Options, repeats), 1, APP_SWEEP_MAX_REPEATS},
    {"again", 0, NULL, "Try again the runs that the solver gave up in an earlier sweep", 1, CLI_FLAG,
     CLI_TO(Options, again)},
    {"json", 'j', NULL, "Print the table as JSON on standard output", 2, CLI_FLAG, CLI_TO(Options, is_json)},
    {"markdown", 'M', NULL, "Print the table as Markdown", 2, CLI_FLAG, CLI_TO(Options, is_markdown)},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static Status parse_axes(const Options *options, AppSweepBase *base) {
  for (int k = 0; k < options->axis_count; k++)
    TRY(app_sweep_axis_parse_linked(base->axes, APP_SWEEP_MAX_AXES, &base->axis_count, options->axes[k]));
  return STATUS_OK;
}

static Status print_table(const AppSweepGrid *grid, const Options *options) {
  if (!options->is_json)
    return app_sweep_table_print(grid, options->is_markdown ? APP_TABLE_MARKDOWN : APP_TABLE_PLAIN, stdout);
  Record *table = app_sweep_table_record(grid);
  if (!table) return status_no_memory("the table of a sweep");
  Status status = record_print(table, stdout);
  record_destroy(table);
  return status;
}

// A sweep with failed runs is one that the solver gave up in part.
static Status conclude(const AppSweepGrid *grid, const Options *options) {
  TRY(print_table(grid, options));
  log_info("wrote %s: sweep.html, sweep.csv, sweep.json; the runs are in the folders beside them",
           grid->base.directory);
  int failed = app_sweep_grid_count(grid, APP_SWEEP_FAILED);
  if (failed == 0) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "%d of %d runs failed; the table says why", failed, grid->point_count);
}

static Status sweep(const Options *options, const char *directory) {
  AppSweepGrid grid = {0};
  AppSweepBase base = {.scene_path = options->scene_path,
                       .directory = directory,
                       .overlap = options->overlap,
                       .overrides = options->overrides,
                       .override_count = options->override_count,
                       .repeat_count = options->repeats};
  Status status = parse_axes(options, &base);
  if (status) {
    for (int a = 0; a < base.axis_count; a++) app_sweep_axis_destroy(&base.axes[a]);
    return status;
  }
  status = app_sweep_grid_create(&grid, &base);
  if (!status) {
    const AppSweepShare share = app_sweep_crew_share(options->jobs, options->threads, grid.point_count);
    const AppSweepOptions run_options = {
        .jobs = share.jobs, .threads = share.threads, .again = options->again, .stop = app_job_stop_flag()};
    status = app_sweep_crew_run(&grid, &run_options);
  }
  if (!status) status = conclude(&grid, options);
  app_sweep_grid_destroy(&grid);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (!options->axis_count && options->repeats == 1)
    argp_error(state,
               "say what varies, as in --vary contact.stiffness=1e5..1e9:5,log, or how often to --repeat");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.repeats = 1};
  app_cli_parse(&app_command_sweep, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  char *directory = options.directory ? memory_copy(options.directory, strlen(options.directory) + 1, 1)
                                      : app_job_default_directory(options.scene_path, "-sweep");
  Status status = directory ? sweep(&options, directory) : status_no_memory("a directory name");
  if (status) log_error("%s", status_message());
  memory_free(directory);
  return status_exit_code(status);
}

const AppCommand app_command_sweep = {
    .name = "sweep",
    .help = "run a scene over a grid of values, side by side",
    .options = option_table,
    .arguments = &(const AppArguments){"SCENE", offsetof(Options, scene_path), 1,
                                       .missing = "name a scene file, as in examples/01_drop.yaml",
                                       .excess = "one scene at a time; '%s' is the second"},
    .doc =
        "Run a scene with every combination of values of some of its keys, side by side: a table and a page "
        "with "
        "plots.\vEach run is a process with a folder of its own, named by its values. The same command, "
        "given "
        "again, completes what is not finished; more values may be added. A run that fails is a line of the "
        "table; then the exit code is 70.",
    .check = check,
    .run = run_command};
