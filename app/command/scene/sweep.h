// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap sweep`: a scene over a grid of values, side by side.
#ifndef TETLAP_APP_COMMAND_SWEEP_H
#define TETLAP_APP_COMMAND_SWEEP_H

#include "app/cli/command.h"

extern const AppCommand app_command_sweep;

#endif
