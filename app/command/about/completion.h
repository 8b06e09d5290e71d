// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap completion SHELL`: a script that makes a shell complete commands and options.
#ifndef TETLAP_APP_COMMAND_COMPLETION_H
#define TETLAP_APP_COMMAND_COMPLETION_H

#include "app/cli/command.h"

extern const AppCommand app_command_completion;

#endif
