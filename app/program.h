// SPDX-License-Identifier: GPL-3.0-or-later
// The program `tetlap`: its table of commands; and how a program with such a table runs.
#ifndef TETLAP_APP_PROGRAM_H
#define TETLAP_APP_PROGRAM_H

#include "app/cli/command.h"

extern const AppCommand app_program_root;

// Whether the arguments call a command that computes on many threads.
bool app_program_has_threads(const AppCommand *root, int argument_count, char *const *arguments);

// Runs the command of `root` that the arguments name; returns the exit code. Prints failures to stderr, also
// that standard output could not be written.
int app_program_run(const AppCommand *root, int argument_count, char **arguments);

// All of `main` of a program in one process: before its command runs, threads are told to sleep while they
// wait.
int app_program_main(const AppCommand *root, int argument_count, char **arguments);

#endif
