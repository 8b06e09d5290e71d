// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap mesh FILE`: counts, volume, quality, bounding box, groups, and what is wrong with a mesh.
#ifndef TETLAP_APP_COMMAND_MESH_H
#define TETLAP_APP_COMMAND_MESH_H

// Returns 0 for a mesh that can be used, with remarks or without; 65 for one that cannot.
int app_mesh_run(int argument_count, char **arguments);

#endif
