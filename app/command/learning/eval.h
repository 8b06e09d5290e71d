// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap eval`: how well an overlap model answers a data set.
#ifndef TETLAP_APP_COMMAND_EVAL_H
#define TETLAP_APP_COMMAND_EVAL_H

#include "app/cli/command.h"

extern const AppCommand app_command_eval;

#endif
