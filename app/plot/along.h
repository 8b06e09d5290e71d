// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of a quantity along a path at some frames of a run or two, as a gnuplot script that holds its
// data.
#ifndef TETLAP_APP_PLOT_ALONG_H
#define TETLAP_APP_PLOT_ALONG_H

#include <stdio.h>

#include "app/plot/sample.h"

enum { APP_PLOT_MAX_TIMES = 6 };

typedef struct AppPlotAlong {
  AppPlotPath path;
  const char *quantity; // of the frames, "NAME" or "NAME:COMPONENT"; of a vector without one its length
  const char *body;     // by name; NULL: all that have points on the path
  double times[APP_PLOT_MAX_TIMES]; // the frames next to them are taken [s]     (time_count)
  int time_count;                   // 0: the last frame
} AppPlotAlong;

// `directories` (count), `labels` likewise. STATUS_INPUT: no frames, no such quantity, component or body, or
// nothing on the path, with what there is; STATUS_USAGE: the picture's name; STATUS_IO; STATUS_MEMORY.
Status app_plot_along(FILE *script, const char *picture, const AppPlotAlong *along,
                      const char *const *directories, int count, const char *const *labels);

#endif
