// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a command line by the command's tables.
#ifndef TETLAP_APP_CLI_PARSE_H
#define TETLAP_APP_CLI_PARSE_H

#include "app/cli/command.h"

// Fills `options`, the struct that the tables of the command are about and that holds the defaults. --help
// prints and ends the program; so does a wrong line, with exit code 64 and what would be right.
void app_cli_parse(const AppCommand *command, int argument_count, char **arguments, void *options);

#endif
