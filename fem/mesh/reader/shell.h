// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a surface of triangles encloses a volume, before a mesher fills it.
#ifndef TETLAP_FEM_MESH_READER_SHELL_H
#define TETLAP_FEM_MESH_READER_SHELL_H

#include "base/status.h"

// STATUS_INPUT: no triangles; an edge with one triangle (open) or more than two (not manifold), with its
// place; more than one shell.
Status fem_mesh_shell_check(const double *positions, int triangle_count, const int (*triangles)[3]);

#endif
