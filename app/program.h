// SPDX-License-Identifier: GPL-3.0-or-later
// The program `tetlap`: its table of commands.
#ifndef TETLAP_APP_PROGRAM_H
#define TETLAP_APP_PROGRAM_H

#include "app/cli/command.h"

extern const AppCommand app_program_root;

// Whether the arguments call a command that computes on many threads.
bool app_program_has_threads(int argument_count, char *const *arguments);

// Runs the command that the arguments name; returns the exit code. Prints failures to stderr.
int app_program_run(int argument_count, char **arguments);

#endif
