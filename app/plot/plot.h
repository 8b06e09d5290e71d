// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures for papers, as gnuplot scripts that hold their data: of the history of a run or two.
#ifndef TETLAP_APP_PLOT_PLOT_H
#define TETLAP_APP_PLOT_PLOT_H

#include <stdio.h>

#include "app/report/run.h"

// Contact forces, energies and step size over time, a panel each; of the second of two runs dashed. `labels`
// (run_count) name the runs. STATUS_INPUT: a run without history.
Status app_plot_history(FILE *script, const char *picture, const AppReportRun *runs, int run_count,
                        const char *const *labels);

#endif
