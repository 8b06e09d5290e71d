// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap version`: versions of the program and its libraries.
#ifndef TETLAP_APP_COMMAND_VERSION_H
#define TETLAP_APP_COMMAND_VERSION_H

#include "app/cli/command.h"

extern const AppCommand app_command_version;

#endif
