// SPDX-License-Identifier: GPL-3.0-or-later
// Commands over several processes: which commands may, and how one process starts the others.
#ifndef TETLAP_APP_CLI_RANKS_H
#define TETLAP_APP_CLI_RANKS_H

#include "app/cli/command.h"
#include "base/status.h"

// Keeps the command line for app_ranks_start; before arguments are read, which splits lists in place.
void app_ranks_keep_line(void);

// How many processes mpiexec, or a batch system, has started of this program.
int app_ranks_started(void);

// STATUS_USAGE: several ranks run this, and the command is for one process; or mpiexec has started several
// times a program of one process.
Status app_ranks_check(const AppCommand *command);

// Whether this process is the one that prints refusals.
bool app_ranks_is_heard(void);

// Goes on as tetlap-mpi in this process, with the same arguments, unless it is that already: only it can
// compute how ranks would divide a mesh.
Status app_ranks_become(void);

// Goes on as `count` ranks: replaces this process by tools/ranks with tetlap-mpi and the same arguments. Does
// nothing if that has been done, or one rank is asked for. STATUS_USAGE: there is no tetlap-mpi beside this
// program, or it runs on another number of ranks.
Status app_ranks_start(int count);

#endif
