// SPDX-License-Identifier: GPL-3.0-or-later
// This program as a child process: it ends with its parent, and a Ctrl-C of the terminal does not reach it.
#ifndef TETLAP_APP_SWEEP_CHILD_H
#define TETLAP_APP_SWEEP_CHILD_H

#include <stdbool.h>
#include <sys/types.h>

#include "base/status.h"

enum { APP_SWEEP_MAX_JOBS = 256 };

// Starts `arguments` (ended by NULL; the first is the program's name). What it prints is added to the file
// `log`. STATUS_IO: no process, or no log.
Status app_sweep_child_start(char *const *arguments, const char *log, pid_t *child);

// Whether it has ended; then its exit code, or 128 + the signal that ended it.
bool app_sweep_child_has_ended(pid_t child, int *exit_code);

// Asks all (MAX_JOBS at most) to stop, kills after `patience_s` those that did not, and waits for all; 0
// among them are none.
void app_sweep_child_stop(const pid_t *children, int count, double patience_s);

#endif
