// SPDX-License-Identifier: GPL-3.0-or-later
// The options of a command, one after another as its tables have them, and those that argp gives to every
// command.
#ifndef TETLAP_APP_CLI_OPTIONS_H
#define TETLAP_APP_CLI_OPTIONS_H

#include <stdbool.h>

#include "app/cli/command.h"

typedef void (*AppCliOptionVisit)(void *self, const AppOption *option);

// Calls `visit` for each option of the command, also of the tables that it shares with others, then for
// --help and --usage.
void app_cli_options_visit(const AppCommand *command, AppCliOptionVisit visit, void *self);

// Whether its argument is the name of a file or a folder.
bool app_cli_options_takes_path(const AppOption *option);

// Whether its argument names overlap models.
bool app_cli_options_takes_model(const AppOption *option);

#endif
