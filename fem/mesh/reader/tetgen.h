// SPDX-License-Identifier: GPL-3.0-or-later
// TetGen's .node and .ele files (Hang Si, TetGen manual, "File formats"): text, # starts a comment, numbering
// from 0 or 1 as the first node says. Tetrahedra of 4 nodes, or of 10 (-o2).
#ifndef TETLAP_FEM_MESH_READER_TETGEN_H
#define TETLAP_FEM_MESH_READER_TETGEN_H

#include "fem/mesh/validate.h"

// Reads NAME.node and NAME.ele, or NAME.NODE and NAME.ELE, given either name. Boundary markers other than 0
// become groups marker_7. STATUS_INPUT: the message names the file and the line. STATUS_IO: one of the two is
// missing.
Status fem_mesh_tetgen_read(FemMeshSource *source, const char *path);

#endif
