// SPDX-License-Identifier: GPL-3.0-or-later
// Scripts by which shells complete commands and their options, made from the same tables as `--help`.
#ifndef TETLAP_APP_CLI_PAGES_COMPLETION_H
#define TETLAP_APP_CLI_PAGES_COMPLETION_H

#include <stdio.h>

#include "app/cli/command.h"

typedef enum AppCliShell {
  APP_CLI_SHELL_BASH,
  APP_CLI_SHELL_ZSH,
  APP_CLI_SHELL_FISH,
  APP_CLI_SHELL_COUNT
} AppCliShell;

// APP_CLI_SHELL_COUNT: no such shell is known.
AppCliShell app_cli_completion_find(const char *name);

// Whether the stream took it, its owner finds out.
void app_cli_completion_print(const AppCommand *program, AppCliShell shell, FILE *stream);

#endif
