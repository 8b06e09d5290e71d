// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap overlap FILE`: the overlap volumes of the user's pairs of tetrahedra.
#ifndef TETLAP_APP_COMMAND_OVERLAP_H
#define TETLAP_APP_COMMAND_OVERLAP_H

#include "app/cli/command.h"

extern const AppCommand app_command_overlap;

#endif
