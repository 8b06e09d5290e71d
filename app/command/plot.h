// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap plot`: pictures for papers.
#ifndef TETLAP_APP_COMMAND_PLOT_H
#define TETLAP_APP_COMMAND_PLOT_H

int app_plot_command_run(int argument_count, char **arguments); // returns the exit code

#endif
