// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include "app/cli/pages/completion.h"
#include "app/cli/parse.h"
#include "base/log.h"
#include "base/status.h"

typedef struct Options {
  const char *name;
  AppCliShell shell;
} Options;

static void check(struct argp_state *state, void *given) {
  Options *options = given;
  options->shell = app_cli_completion_find(options->name);
  if (options->shell == APP_CLI_SHELL_COUNT)
    argp_error(state, "'%s' is none of: bash, zsh, fish", options->name);
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_completion, argument_count, arguments, &options);
  app_cli_completion_print(app_cli_command_root(), options.shell, stdout);
  if (fflush(stdout) == 0) return 0;
  log_error("standard output cannot be written");
  return status_exit_code(STATUS_IO);
}

const AppCommand app_command_completion = {
    .name = "completion",
    .help = "print a script that makes a shell complete commands and options",
    .arguments = &(const AppArguments){"bash|zsh|fish", offsetof(Options, name), 1,
                                       .missing = "name a shell: bash, zsh or fish",
                                       .excess = "'%s' is one argument too many: name one shell"},
    .doc = "Print a script that makes a shell complete commands and options. bash: source <(tetlap "
           "completion bash); zsh: "
           "save it as _tetlap in a folder of $fpath; fish: tetlap completion fish | source",
    .check = check,
    .run = run_command};
