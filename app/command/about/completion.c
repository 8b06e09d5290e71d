// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/about/completion.h"

#include <string.h>

#include "app/cli/completion.h"
#include "base/log.h"
#include "base/status.h"

static error_t parse(int key, char *text, struct argp_state *state) {
  AppCliShell *shell = state->input;
  switch (key) {
  case ARGP_KEY_ARG:
    if (*shell != APP_CLI_SHELL_COUNT)
      argp_error(state, "'%s' is one argument too many: name one shell", text);
    *shell = app_cli_completion_find(text);
    if (*shell == APP_CLI_SHELL_COUNT) argp_error(state, "'%s' is none of: bash, zsh, fish", text);
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name a shell: bash, zsh or fish");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp argp = {
    .parser = parse,
    .args_doc = "bash|zsh|fish",
    .doc = "Print a script that makes a shell complete commands and options. bash: source <(tetlap "
           "completion bash); zsh: "
           "save it as _tetlap in a folder of $fpath; fish: tetlap completion fish | source"};

static int run_command(int argument_count, char **arguments) {
  AppCliShell shell = APP_CLI_SHELL_COUNT;
  argp_parse(&argp, argument_count, arguments, 0, NULL, &shell);
  app_cli_completion_print(app_cli_command_root(), shell, stdout);
  if (fflush(stdout) == 0) return 0;
  log_error("standard output cannot be written");
  return status_exit_code(STATUS_IO);
}

const AppCommand app_command_completion = {
    .name = "completion",
    .help = "print a script that makes a shell complete commands and options",
    .argp = &argp,
    .run = run_command};
