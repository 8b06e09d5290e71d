// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap pareto [SCENE…]`: error against time of every overlap model and of a sweep of network sizes.
#ifndef TETLAP_APP_COMMAND_PARETO_H
#define TETLAP_APP_COMMAND_PARETO_H

#include "app/cli/command.h"

extern const AppCommand app_command_pareto;

#endif
