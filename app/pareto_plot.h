// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef TETLAP_APP_PARETO_PLOT_H
#define TETLAP_APP_PARETO_PLOT_H

#include "app/pareto.h"

// Draws the frontier, a panel for each set and quantity: pareto.svg and pareto.png in the directory, by the
// gnuplot script pareto.gp, which is kept and holds the points. STATUS_IO: gnuplot is missing or failed.
Status app_pareto_plot(const AppPareto *pareto, const char *directory);

#endif
