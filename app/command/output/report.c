// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/cli/parse.h"
#include "app/report/collect.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"

enum { MOST_FRAMES = 1000000 };

typedef struct Options {
  const char *directories[APP_REPORT_MAX_RUNS];
  int directory_count;
  const char *output;
  const char *pareto;
  const char *stresses[APP_REPORT_MAX_STRESSES];
  int stress_count;
  int max_frames;
  bool has_surface_only, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "FILE", "Write this file (default: report.html in the first DIR, else here)", 0, CLI_TEXT,
     CLI_TO(Options, output)},
    {"frames", 0, "N", "Take at most N frames of a run, evenly spaced (default: all)", 0, CLI_INTEGER,
     CLI_TO(Options, max_frames), 1, MOST_FRAMES},
    {"surface", 0, NULL, "Take the bodies' surfaces only: a smaller page, which cannot cut bodies open", 0,
     CLI_FLAG, CLI_TO(Options, has_surface_only)},
    {"pareto", 0, "FILE", "Show this result of tools/measure/frontier as well", 0, CLI_TEXT,
     CLI_TO(Options, pareto)},
    {"stress", 0, "FILE",
     "Show this table of `tetlap stress --json` as well; may be repeated: a later one replaces the same "
     "cases",
     0, CLI_REPEATED, CLI_TO(Options, stresses), .most = APP_REPORT_MAX_STRESSES,
     .example = "tables of stress", .count_offset = offsetof(Options, stress_count)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static Status add_stress(AppReport *report, const char *path) {
  Record **record = &report->stresses[report->stress_count];
  TRY(record_read(record, path));
  report->stress_count++;
  const char *format = record_find_text(*record, "format");
  if (format && strcmp(format, "tetlap-stress 1") == 0) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "%s: is no table of hard cases; give what `tetlap stress --json FILE` wrote", path);
}

static Status collect(AppReport *report, const Options *options) {
  report->has_surface_only = options->has_surface_only;
  for (int k = 0; k < options->directory_count; k++)
    TRY(app_report_collect(report, options->directories[k], options->directory_count == 1,
                           options->max_frames));
  if (options->pareto) TRY(record_read(&report->pareto, options->pareto));
  for (int k = 0; k < options->stress_count; k++) TRY(add_stress(report, options->stresses[k]));
  return STATUS_OK;
}

// The folder of a file as the system has it; "": there is none.
static void find_folder(const char *path, char folder[PATH_MAX]) {
  if (!realpath(path, folder)) {
    folder[0] = 0;
    return;
  }
  char *slash = strrchr(folder, '/');
  if (slash) slash[slash == folder] = 0;
}

static bool is_page(const char *path) {
  const char *dot = strrchr(path, '.');
  return dot && (strcmp(dot, ".html") == 0 || strcmp(dot, ".htm") == 0);
}

// Whether it is a file in the folder that is no page.
static bool is_in(const char *directory, const char *output) {
  char folder[PATH_MAX];
  struct stat info;
  if (stat(output, &info) != 0 || !S_ISREG(info.st_mode)) return false;
  find_folder(output, folder);
  return !is_page(output) && folder[0] && file_is_same(folder, directory);
}

// Whether a page there would take the place of what a run wrote, or of its scene.
static bool is_of_run(const AppReportRun *run, const char *output) {
  const char *scene = record_find_text(run->summary, "scene");
  return (scene && file_is_same(scene, output)) || is_in(run->directory, output);
}

static bool is_input(const Options *options, const char *output) {
  bool is_one = options->pareto && file_is_same(options->pareto, output);
  for (int k = 0; k < options->stress_count; k++)
    is_one = is_one || file_is_same(options->stresses[k], output);
  return is_one;
}

static Status check_output(const AppReport *report, const Options *options) {
  if (!options->output) return STATUS_OK;
  bool is_taken = is_input(options, options->output) ||
                  (report->verdict && is_in(options->directories[0], options->output));
  for (int r = 0; r < report->run_count; r++)
    is_taken = is_taken || is_of_run(&report->runs[r], options->output);
  if (!is_taken) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "-o %s: the page would replace a file that it is made from; name another, as in "
                     "-o report.html",
                     options->output);
}

static Status write_page(AppReport *report, const Options *options) {
  char *path = options->output            ? memory_copy(options->output, strlen(options->output) + 1, 1)
               : options->directory_count ? file_join(options->directories[0], "report.html")
                                          : file_join(".", "report.html");
  if (!path) return status_no_memory("a file name");
  Status status = app_report_write(report, path);
  struct stat info;
  if (!status && stat(path, &info) == 0)
    log_info("wrote %s (%.1f MB): open it in a browser", path, (double)info.st_size / 1e6);
  memory_free(path);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (options->directory_count + options->stress_count == 0 && !options->pareto)
    argp_error(state, "name the directory of a run, of two runs, of a comparison or of a verdict");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_report, argument_count, arguments, &options);
  if (options.is_quiet) log_set_level(LOG_ERROR);
  AppReport report = {0};
  Status status = collect(&report, &options);
  if (!status) status = check_output(&report, &options);
  if (!status) status = write_page(&report, &options);
  app_report_destroy(&report);
  return app_cli_command_end(status);
}

const AppCommand app_command_report = {
    .name = "report",
    .help = "write a web page about a run, or several side by side",
    .options = option_table,
    .arguments =
        &(const AppArguments){"[DIR…]", offsetof(Options, directories), APP_REPORT_MAX_RUNS,
                              offsetof(Options, directory_count),
                              .excess = "'%s' is one argument too many: a page shows at most %d runs"},
    .doc = "Write a web page about a run, or about several side by side: the scene in motion, its plots, "
           "where the "
           "time went.\vDIR is where `tetlap run` wrote, or `tetlap compare` (then all its models are "
           "shown) or "
           "`tetlap verdict`. The "
           "first is the one that the others are held against. The page is one file and needs no network.",
    .check = check,
    .run = run_command};
