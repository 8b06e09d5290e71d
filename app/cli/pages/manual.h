// SPDX-License-Identifier: GPL-3.0-or-later
// Manual pages for man(1), made from the tables of commands and their options: one for the program and one
// for each command, as tetlap.1, tetlap-run.1, tetlap-dataset-info.1.
#ifndef TETLAP_APP_CLI_PAGES_MANUAL_H
#define TETLAP_APP_CLI_PAGES_MANUAL_H

#include <stdio.h>

#include "app/cli/command.h"
#include "base/status.h"

// The page of one command. `called`: the words that call it, as "tetlap dataset". STATUS_MEMORY; whether the
// stream took it, its owner finds out.
Status app_cli_manual_print(const AppCommand *command, const char *called, FILE *stream);

// The pages of a command and all below it, as files in the folder, which is made. STATUS_IO names the file.
Status app_cli_manual_write(const AppCommand *command, const char *called, const char *directory);

#endif
