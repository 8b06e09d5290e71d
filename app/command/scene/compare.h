// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap compare SCENE --overlap a,b,c`: the same scene with each overlap model, and what differs.
#ifndef TETLAP_APP_COMMAND_COMPARE_H
#define TETLAP_APP_COMMAND_COMPARE_H

#include "app/cli/command.h"

extern const AppCommand app_command_compare;

#endif
