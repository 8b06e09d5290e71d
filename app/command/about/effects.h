// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap effects`: what can act on bodies, and the names that a scene chooses from.
#ifndef TETLAP_APP_COMMAND_EFFECTS_H
#define TETLAP_APP_COMMAND_EFFECTS_H

#include "app/cli/command.h"

extern const AppCommand app_command_effects;

#endif
