// SPDX-License-Identifier: GPL-3.0-or-later
// The program `tetlap`: chooses the subcommand.
#ifndef TETLAP_APP_PROGRAM_H
#define TETLAP_APP_PROGRAM_H

// Runs the subcommand that the arguments name; returns the exit code. Prints failures to stderr.
int app_program_run(int argument_count, char **arguments);

#endif
