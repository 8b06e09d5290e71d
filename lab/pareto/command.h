// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab pareto [SCENE…]`: error against time of every overlap model and of a sweep of network sizes.
#ifndef TETLAP_LAB_PARETO_COMMAND_H
#define TETLAP_LAB_PARETO_COMMAND_H

#include "app/cli/command.h"

extern const AppCommand lab_pareto_command;

#endif
