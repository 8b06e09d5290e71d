// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <signal.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "app/loop/serve.h"
#include "base/log.h"

typedef struct ServeOptions {
  AppLoopOptions loop;
  const char *channel;
  int socket, memory; // descriptors
} ServeOptions;

static const AppOption option_table[] = {
    {"overlap", 'm', "NAME", "Take this overlap model instead of the scene's", 1, CLI_TEXT,
     CLI_TO(ServeOptions, loop.overlap)},
    {"channel", 0, "SOCKET,MEMORY",
     "Two descriptors that the other process hands over: a socket, and a file to share memory by", 1,
     CLI_TEXT, CLI_TO(ServeOptions, channel)},
    {.table = app_job_options, .offset = offsetof(ServeOptions, loop.job)},
    {0},
};

static void check(struct argp_state *state, void *given) {
  ServeOptions *options = given;
  if (!options->channel)
    argp_error(state, "--channel is missing: another process starts this command, as tetlap.Simulation does");
  if (sscanf(options->channel, "%d,%d", &options->socket, &options->memory) != 2 || options->socket < 3 ||
      options->memory < 3)
    argp_error(state, "--channel %s: expected two descriptors that are open, as in 5,6", options->channel);
}

static int run_command(int argument_count, char **arguments) {
  ServeOptions options = {0};
  app_cli_parse(&app_command_serve, argument_count, arguments, &options);
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
