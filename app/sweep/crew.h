// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the points of a grid side by side as child processes, each in a folder of its own:
//
//   grid ─► each point examined: finished, to resume, to run
//     children, `jobs` at once ─► concluded one by one ─► sweep.json, sweep.csv, sweep.html, each time anew
#ifndef TETLAP_APP_SWEEP_CREW_H
#define TETLAP_APP_SWEEP_CREW_H

#include <signal.h>

#include "app/sweep/grid.h"

typedef struct AppSweepOptions {
  int jobs;                          // runs at once
  int threads;                       // of each run
  bool again;                        // runs that the solver gave up are tried again
  const volatile sig_atomic_t *stop; // ends the sweep when it is raised
} AppSweepOptions;

// How the cores are divided among runs side by side: by `tetlap sweep`, and by tetlap.map of the Python
// package.
typedef struct AppSweepShare {
  int jobs;    // runs at once, 1 … APP_SWEEP_MAX_JOBS
  int threads; // of each, at least 1
} AppSweepShare;

// `count` runs: one a core, and what is left of the cores as threads; `jobs` and `threads` are what was asked
// for (0: nothing).
AppSweepShare app_sweep_crew_share(int jobs, int threads, int count);

// Examines all, runs what is not finished, and keeps the table. A point that fails is part of the table; if
// none can be read, that is the sweep's failure. STATUS_INTERRUPTED: stopped; what is there can be gone on
// with.
Status app_sweep_crew_run(AppSweepGrid *grid, const AppSweepOptions *options);

#endif
