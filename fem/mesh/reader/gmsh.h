// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and meshing by gmsh; with fem/mesh/reader/gmsh_model.c the only place where its API is used.
//
// gmsh keeps its state in globals, sets the number of OpenMP threads, runs for minutes without a way to stop
// it, and falls over some damaged files. So this is not called directly but given to fem_mesh_worker_run,
// which runs it in a process of its own.
#ifndef TETLAP_FEM_MESH_READER_GMSH_H
#define TETLAP_FEM_MESH_READER_GMSH_H

#include "fem/mesh/validate.h"

// Opens what gmsh can open; a .stl surface is closed into a volume and filled, a .geo is meshed unless it
// meshes itself. Fixed seeds and one thread: the same file gives the same mesh. STATUS_INPUT: the message
// does not name the file.
Status fem_mesh_gmsh_read(FemMeshSource *source, const char *path, const FemMeshOptions *options);

#endif
