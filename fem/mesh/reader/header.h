// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a mesh file, checked before gmsh reads it. gmsh takes a truncated MEDIT file for a smaller
// mesh, leaves out elements that it does not know, and runs a file without a known beginning as a script.
#ifndef TETLAP_FEM_MESH_READER_HEADER_H
#define TETLAP_FEM_MESH_READER_HEADER_H

#include <stddef.h>

#include "base/status.h"

typedef enum FemMeshFormat {
  FEM_MESH_FORMAT_MSH,
  FEM_MESH_FORMAT_MEDIT,
  FEM_MESH_FORMAT_VTK,
  FEM_MESH_FORMAT_STL,
  FEM_MESH_FORMAT_GEO,
  FEM_MESH_FORMAT_TETGEN,
} FemMeshFormat;

// By the ending, upper or lower case. STATUS_INPUT: an ending that is not known; the message lists them.
Status fem_mesh_header_format(const char *path, FemMeshFormat *format);

// What is known of a file before it is read.
typedef struct FemMeshHeader {
  size_t size;         // of the file [bytes]
  long long tet_count; // that it announces; −1: the format does not say, or gmsh checks it itself
} FemMeshHeader;

// Checks that the file begins as its format does and can hold what it announces.
// STATUS_IO: not there, not a file, not readable. STATUS_INPUT: empty, or not this format, or other elements.
Status fem_mesh_header_check(const char *path, FemMeshFormat format, FemMeshHeader *header);

#endif
