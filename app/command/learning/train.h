// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap train`: a learned overlap model from a configuration.
#ifndef TETLAP_APP_COMMAND_TRAIN_H
#define TETLAP_APP_COMMAND_TRAIN_H

#include "app/cli/command.h"

extern const AppCommand app_command_train;

#endif
