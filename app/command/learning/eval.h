// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap eval`: the accuracy of an overlap model on a data set.
#ifndef TETLAP_APP_COMMAND_EVAL_H
#define TETLAP_APP_COMMAND_EVAL_H

#include "app/cli/command.h"

extern const AppCommand app_command_eval;

#endif
