// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap stress`: every hard case with every overlap model, as a table.
#ifndef TETLAP_APP_COMMAND_STRESS_H
#define TETLAP_APP_COMMAND_STRESS_H

#include "app/cli/command.h"

extern const AppCommand app_command_stress;

#endif
