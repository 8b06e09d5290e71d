// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap mesh FILE`: counts, volume, quality, bounding box, groups, and what is wrong with a mesh.
#ifndef TETLAP_APP_COMMAND_MESH_H
#define TETLAP_APP_COMMAND_MESH_H

#include "app/cli/command.h"

// Its exit code is 0 for a mesh that can be used, with remarks or without; 65 for one that cannot.
extern const AppCommand app_command_mesh;

#endif
