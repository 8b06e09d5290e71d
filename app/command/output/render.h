// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap render`: pictures and movies of runs.
#ifndef TETLAP_APP_COMMAND_RENDER_H
#define TETLAP_APP_COMMAND_RENDER_H

#include "app/cli/command.h"

extern const AppCommand app_command_render;

#endif
