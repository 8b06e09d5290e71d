// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset merge FILE…`: joins files.
#ifndef TETLAP_APP_COMMAND_DATASET_MERGE_H
#define TETLAP_APP_COMMAND_DATASET_MERGE_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset_merge;

#endif
