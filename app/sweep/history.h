// SPDX-License-Identifier: GPL-3.0-or-later
// The course of a run's contact force: the largest between any two bodies, over time, from its history.csv.
#ifndef TETLAP_APP_SWEEP_HISTORY_H
#define TETLAP_APP_SWEEP_HISTORY_H

#include "base/status.h"

enum { APP_SWEEP_MOST_TIMES = 100 };

// Of long histories each entry is the largest of several rows.
typedef struct AppSweepHistory {
  int count;
  double time[APP_SWEEP_MOST_TIMES];  // at the end of those rows [s]
  double force[APP_SWEEP_MOST_TIMES]; // [N]
} AppSweepHistory;

// Of the run in `directory`; count 0: it has none, or none with such a column. STATUS_MEMORY.
Status app_sweep_history_read(AppSweepHistory *history, const char *directory);

#endif
