// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/cli/ranks.h"
#include "app/cli/versions.h"
#include "app/command/scene/run.h"
#include "app/job/origin.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/run/checkpoint/checkpoint.h"

static const AppOption option_table[] = {
    {"threads", 't', "N", "Use N threads (default: the scene's, else all)", 1, CLI_INTEGER,
     CLI_TO(AppRunOptions, job.threads), 1, APP_CLI_MOST_THREADS},
    {"strict", 0, NULL,
     "Energy gained beyond 0.1 % of the scene's, and bodies that pass through each other, are an error", 1,
     CLI_FLAG, CLI_TO(AppRunOptions, is_strict)},
    {"ranks", 0, "N", "Share the run among N processes of this machine (tetlap-mpi)", 1, CLI_INTEGER,
     CLI_TO(AppRunOptions, rank_count), 1, RANKS_MOST},
    {"json", 'j', NULL, "Print the result as JSON on standard output", 2, CLI_FLAG,
     CLI_TO(AppRunOptions, job.is_json)},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(AppRunOptions, job.is_quiet)},
    {"verbose", 'v', NULL, "Print a line per step, and why one is taken back", 2, CLI_FLAG,
     CLI_TO(AppRunOptions, job.is_verbose)},
    {0},
};

static Status read_checkpoint(const char *directory, const char *path, FemCheckpoint *checkpoint) {
  if (file_exists(directory) && !file_exists(path))
    return status_fail(STATUS_INPUT,
                       "%s: there is no checkpoint.h5 to continue from: the run has reached its end, or was "
                       "killed before the first was written; start again with `tetlap run`",
                       directory);
  return fem_checkpoint_read(checkpoint, path);
}

// Other instructions round otherwise: nothing to refuse, but the promise of the last bit is off.
static void warn_of_processor(const Record *origin) {
  const char *was = record_find_text(origin, "instructions");
  if (was && strcmp(was, app_versions_simd()) != 0)
    log_warning("the run began on a processor with other instructions (%s, here %s): it continues, but the "
                "last bits may differ",
                was, app_versions_simd());
}

// The manifest says how the run was begun.
static void keep_command(const Record *origin) {
  const char *command = record_find_text(origin, "command");
  char *words[] = {(char *)command};
  if (command) app_versions_set_command(1, words);
}

static Status go_on(AppRunOptions *options, const char *path, FemCheckpoint *checkpoint, Record *origin) {
  TRY(app_origin_read(origin, path, &options->job, &options->overlap));
  warn_of_processor(origin);
  keep_command(origin);
  file_remove_parts(options->job.directory);
  options->from = checkpoint;
  options->from_path = path;
  options->origin = origin;
  log_info("%s: continues from t = %g s, frame %d", options->job.directory, checkpoint->time,
           checkpoint->next_frame);
  return app_run_execute(options);
}

static Status resume(AppRunOptions *options) {
  FemCheckpoint checkpoint = {0};
  Record *origin = NULL;
  char *path = file_join(options->job.directory, FEM_CHECKPOINT_FILE);
  Status status =
      path ? read_checkpoint(options->job.directory, path, &checkpoint) : status_no_memory("a file name");
  if (!status) status = record_parse(&origin, checkpoint.origin, strlen(checkpoint.origin), path);
  if (status)
    log_error("%s", status_message());
  else
    status = go_on(options, path, &checkpoint, origin);
  if (origin) record_destroy(origin);
  fem_checkpoint_destroy(&checkpoint);
  memory_free(path);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  AppRunOptions options = {0};
  app_cli_parse(&app_command_resume, argument_count, arguments, &options);
  app_job_prepare(&options.job);
  Status status = app_ranks_start(options.rank_count);
  if (status) log_error("%s", status_message());
  return status_exit_code(status ? status : resume(&options));
}

const AppCommand app_command_resume = {
    .name = "resume",
    .help = "continue a run that was stopped or killed",
    .options = option_table,
    .arguments = &(const AppArguments){"DIR", offsetof(AppRunOptions, job.directory), 1,
                                       .missing = "name the folder that the run wrote into",
                                       .excess = "one run at a time; '%s' is the second"},
    .doc = "Continue a run that was stopped or killed, from its last checkpoint in DIR. The files are the "
           "same, to the last bit, as those of an uninterrupted run. The scene, its meshes and weights and "
           "the program must be unchanged.",
    .run = run_command,
    .has_threads = true,
    .has_ranks = true};
