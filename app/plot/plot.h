// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures for papers, as gnuplot scripts that hold their data: of the history of a run or two, and of the
// frontier of error and time.
#ifndef TETLAP_APP_PLOT_PLOT_H
#define TETLAP_APP_PLOT_PLOT_H

#include <stdio.h>

#include "app/report/run.h"

// Contact forces, energies and step size over time, a panel each; of the second of two runs dashed. `labels`
// (run_count) name the runs. STATUS_INPUT: a run without history.
Status app_plot_history(FILE *script, const char *picture, const AppReportRun *runs, int run_count,
                        const char *const *labels);

// Error against time of every point of a pareto.json, a panel for each quantity and set; of `quantities`
// (comma-separated; NULL: all). STATUS_INPUT: no such points.
Status app_plot_frontier(FILE *script, const char *picture, const Record *pareto, const char *quantities);

#endif
