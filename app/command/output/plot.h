// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap plot`: pictures for papers.
#ifndef TETLAP_APP_COMMAND_PLOT_H
#define TETLAP_APP_COMMAND_PLOT_H

#include "app/cli/command.h"

extern const AppCommand app_command_plot;

#endif
