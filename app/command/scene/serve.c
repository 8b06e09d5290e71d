// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <signal.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "app/loop/serve.h"
#include "app/sweep/crew.h"
#include "base/files/record.h"
#include "base/log.h"

typedef struct ServeOptions {
  AppLoopOptions loop;
  const char *channel, *divide;
  int socket, memory; // descriptors
} ServeOptions;

static const AppOption option_table[] = {
    {"overlap", 'm', "NAME", "Take this overlap model instead of the scene's", 1, CLI_TEXT,
     CLI_TO(ServeOptions, loop.overlap)},
    {"channel", 0, "SOCKET,MEMORY",
     "Two descriptors that the other process hands over: a socket, and a file to share memory by", 1,
     CLI_TEXT, CLI_TO(ServeOptions, channel)},
    {"divide", 0, "JOBS,THREADS,COUNT",
     "Print how many of COUNT runs go at once and with how many threads, and this program's version, as "
     "JSON; 0: "
     "not asked for. No scene is opened",
     1, CLI_TEXT, CLI_TO(ServeOptions, divide)},
    {.table = app_job_options, .offset = offsetof(ServeOptions, loop.job)},
    {0},
};

static void check(struct argp_state *state, void *given) {
  ServeOptions *options = given;
  if (options->divide) return;
  if (!options->channel)
    argp_error(state, "--channel is missing: another process starts this command, as tetlap.Simulation does");
  if (sscanf(options->channel, "%d,%d", &options->socket, &options->memory) != 2 || options->socket < 3 ||
      options->memory < 3)
    argp_error(state, "--channel %s: expected two descriptors that are open, as in 5,6", options->channel);
}

// tetlap.map divides the cores as `tetlap sweep` does.
static Status print_share(const char *divide) {
  int jobs, threads, count;
  if (sscanf(divide, "%d,%d,%d", &jobs, &threads, &count) != 3 || jobs < 0 || threads < 0 || count < 0)
    return status_fail(STATUS_USAGE, "--divide %s: expected three counts, as in 0,0,100", divide);
  const AppSweepShare share = app_sweep_crew_share(jobs, threads, count);
  Record *record = record_new();
  if (!record) return status_no_memory("a share of the cores");
  record_integer(record, "jobs", share.jobs);
  record_integer(record, "threads", share.threads);
  record_text(record, "program", app_versions_line());
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  ServeOptions options = {0};
  app_cli_parse(&app_command_serve, argument_count, arguments, &options);
  if (options.divide) return app_cli_command_end(print_share(options.divide));
  app_job_prepare(&options.loop.job);
  signal(SIGINT, SIG_IGN); // a Ctrl-C is the other process's, which ends this one
  options.loop.stop = app_job_stop_flag();
  return app_cli_command_end(app_loop_serve(&options.loop, options.socket, options.memory));
}

const AppCommand app_command_serve = {
    .name = "serve",
    .help = "let another process step a run (tetlap.Simulation does)",
    .options = option_table,
    .arguments = &app_job_scene,
    .doc = "Let another process step a run: it is what tetlap.Simulation of the Python package starts. "
           "Nothing is "
           "written. The words that go through the socket are in app/loop/serve.h of the sources.",
    .check = check,
    .run = run_command,
    .has_threads = true};
