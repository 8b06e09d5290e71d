// SPDX-License-Identifier: GPL-3.0-or-later
// The options of a command, one after another as its tables have them, and those that argp gives to every
// command.
#ifndef TETLAP_APP_CLI_OPTIONS_H
#define TETLAP_APP_CLI_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

typedef void (*AppCliOptionVisit)(void *self, const struct argp_option *option);

// Calls `visit` for each option of the command, then of the tables that it shares with others, then --help
// and --usage.
void app_cli_options_visit(const struct argp *argp, AppCliOptionVisit visit, void *self);

// Whether the option's key is a letter, as in -o.
bool app_cli_options_has_letter(const struct argp_option *option);

// Whether its argument is the name of a file or a folder.
bool app_cli_options_takes_path(const struct argp_option *option);

// Whether its argument names overlap models.
bool app_cli_options_takes_model(const struct argp_option *option);

#endif
