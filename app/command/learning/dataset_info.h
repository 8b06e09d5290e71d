// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset info FILE`: says what a data set holds.
#ifndef TETLAP_APP_COMMAND_DATASET_INFO_H
#define TETLAP_APP_COMMAND_DATASET_INFO_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset_info;

#endif
