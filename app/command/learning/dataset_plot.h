// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset plot FILE`: draws its kinds and volumes.
#ifndef TETLAP_APP_COMMAND_DATASET_PLOT_H
#define TETLAP_APP_COMMAND_DATASET_PLOT_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset_plot;

#endif
