// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset import FILE`: makes a data set of the user's own labelled pairs.
#ifndef TETLAP_APP_COMMAND_DATASET_IMPORT_H
#define TETLAP_APP_COMMAND_DATASET_IMPORT_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset_import;

#endif
