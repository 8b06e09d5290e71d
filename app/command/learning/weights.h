// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap weights`: the metadata of a weights file.
#ifndef TETLAP_APP_COMMAND_WEIGHTS_H
#define TETLAP_APP_COMMAND_WEIGHTS_H

#include "app/cli/command.h"

extern const AppCommand app_command_weights;

#endif
