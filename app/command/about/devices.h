// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap devices`: accelerators that are there, what was looked for, and why something is not usable.
#ifndef TETLAP_APP_COMMAND_DEVICES_H
#define TETLAP_APP_COMMAND_DEVICES_H

#include "app/cli/command.h"

extern const AppCommand app_command_devices;

#endif
