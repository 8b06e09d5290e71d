// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap check SCENE`: what a run would do, without running.
#ifndef TETLAP_APP_COMMAND_CHECK_H
#define TETLAP_APP_COMMAND_CHECK_H

#include "app/cli/command.h"

extern const AppCommand app_command_check;

#endif
