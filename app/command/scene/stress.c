// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "app/job/job.h"
#include "app/stress/all.h"
#include "app/stress/stress.h"
#include "base/log.h"
#include "base/machine/cpu.h"

typedef struct Options {
  AppStressOptions stress;
  const char *json;
  bool is_quiet;
} Options;

static const AppOption option_table[] = {
    {"only", 0, "NAME", "Only cases with NAME in their name", 0, CLI_TEXT, CLI_TO(Options, stress.only)},
    {"overlap", 'm', "NAME,...",
     "Only these overlap models, with --pairs weights files, too; any: scenes in which none takes part "
     "(default: all; with --quick clip and geo)",
     0, CLI_WORDS, CLI_TO(Options, stress.models), .example = "clip,geo"},
    {"pairs", 0, NULL, "Only classes of pairs", 0, CLI_FLAG, CLI_TO(Options, stress.has_pairs)},
    {"scenes", 0, NULL, "Only scenes", 0, CLI_FLAG, CLI_TO(Options, stress.has_scenes)},
    {"quick", 0, NULL, "Fewer members of each class, and only the scenes that take a moment", 0, CLI_FLAG,
     CLI_TO(Options, stress.is_quick)},
    {"limit", 0, "SECONDS",
     "Stop a scene with a model after this processor time (default: the case's own, 60 or more)", 0,
     CLI_POSITIVE, CLI_TO(Options, stress.limit_s)},
    {"json", 'j', "FILE", "Write the table and all that was measured to FILE, anew after every row", 0,
     CLI_TEXT, CLI_TO(Options, json)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static Status write_json(const AppStress *stress, const char *path) {
  Record *record = record_new();
  if (!record) return status_no_memory("the table of hard cases");
  record_text(record, "command", app_versions_command());
  record_text(record, "processor", cpu_name());
  record_integer(record, "threads", cpu_thread_count());
  app_versions_record(record_child(record, "versions"));
  Status status = app_stress_record(stress, record);
  if (!status) status = record_write(record, path);
  record_destroy(record);
  return status;
}

// What is known so far is on disk, should the machine go down.
static void write_partial(void *observer, const AppStress *stress) {
  const Options *options = observer;
  const AppStressRow *row = &stress->rows[stress->count - 1];
  log_progress("%s, %s: %s", row->name, row->model, app_stress_outcome_name(row->outcome));
  if (options->json && write_json(stress, options->json)) log_warning("%s", status_message());
}

// The table, also of a run that was interrupted; a case that failed is a failure of the command.
static Status print_and_judge(const Options *options, const AppStress *stress) {
  if (!options->is_quiet) app_stress_print(stress, stdout);
  if (options->json) TRY(write_json(stress, options->json));
  int failed = app_stress_count(stress, APP_STRESS_FAILED);
  return failed ? status_fail(STATUS_SOLVER, "%d of %d hard cases failed", failed, stress->count) : STATUS_OK;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_stress, argument_count, arguments, &options);
  if (!options.stress.has_pairs && !options.stress.has_scenes)
    options.stress.has_pairs = options.stress.has_scenes = true;
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  options.stress.stop = app_job_stop_flag();
  options.stress.observe = write_partial, options.stress.observer = &options;
  AppStress stress;
  Status status = app_stress_all_run(&options.stress, &stress);
  log_progress_end();
  if (status) log_error("%s", status_message());
  Status concluded = stress.count > 0 ? print_and_judge(&options, &stress) : STATUS_OK;
  if (concluded && !status) log_error("%s", status_message());
  app_stress_destroy(&stress);
  return status_exit_code(status ? status : concluded);
}

const AppCommand app_command_stress = {
    .name = "stress",
    .help = "check every hard case against physics, with every overlap model",
    .options = option_table,
    .arguments =
        &(const AppArguments){.excess =
                                  "'%s' is one argument too many: there are only options, as --only NAME"},
    .doc = "Hard cases: every class of pairs and every hard scene with every overlap model, each checked "
           "against physics. docs/stability.md explains the verdicts.",
    .run = run_command,
    .has_threads = true};
