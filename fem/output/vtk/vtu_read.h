// SPDX-License-Identifier: GPL-3.0-or-later
// Frames read back: the form that fem/output/vtk/vtu.h writes (zlib blocks as base64 text in their elements),
// no other of VTK's.
#ifndef TETLAP_FEM_OUTPUT_VTK_VTU_READ_H
#define TETLAP_FEM_OUTPUT_VTK_VTU_READ_H

#include <stdbool.h>

#include "base/status.h"
#include "fem/output/vtk/vtu.h"

enum { FEM_VTU_MAX_FIELDS = 48, FEM_VTU_MAX_NAME = 64 };

typedef struct FemVtuField {
  char name[FEM_VTU_MAX_NAME];
  bool is_cell;    // a tuple a cell, else one a vertex
  bool is_integer; // written as such
  int components;
  double *values; // (cell_count or vertex_count, components)
} FemVtuField;

typedef struct FemVtuContent {
  double time; // [s]; NaN: the frame has none
  int vertex_count;
  double *positions; // [m]                                (vertex_count, 3)
  FemVtuCell cell;   // of all of them
  int cell_count;
  int *cells;                             // vertices, each within vertex_count (cell_count, 4 or 3)
  FemVtuField fields[FEM_VTU_MAX_FIELDS]; // in the order of the file          (field_count)
  int field_count;
} FemVtuContent;

// Owned by the caller. STATUS_INPUT: not a frame of ours, with what is wrong; STATUS_IO; STATUS_MEMORY. After
// a failure there is nothing to destroy.
Status fem_vtu_read(const char *path, FemVtuContent *content);
void fem_vtu_read_destroy(FemVtuContent *content); // a zeroed one, too

#endif
