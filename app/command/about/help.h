// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap help`: the list of commands, their help, the manual pages.
#ifndef TETLAP_APP_COMMAND_HELP_H
#define TETLAP_APP_COMMAND_HELP_H

#include "app/cli/command.h"

extern const AppCommand app_command_help;

#endif
