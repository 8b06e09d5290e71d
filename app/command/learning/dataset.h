// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset VERB`: what to do with data set files.
#ifndef TETLAP_APP_COMMAND_DATASET_H
#define TETLAP_APP_COMMAND_DATASET_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset;

#endif
