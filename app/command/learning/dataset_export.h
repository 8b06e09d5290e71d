// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset export FILE -o PAIRS.npy`: a data set as a NumPy array of records.
#ifndef TETLAP_APP_COMMAND_DATASET_EXPORT_H
#define TETLAP_APP_COMMAND_DATASET_EXPORT_H

#include "app/cli/command.h"

extern const AppCommand app_command_dataset_export;

#endif
