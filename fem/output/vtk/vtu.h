// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of a run as a VTK XML unstructured grid (.vtu): arrays compressed by zlib in blocks, as base64
// text in their elements ("VTK XML Formats" in the VTK documentation).
//
// Not as appended data, which would be a quarter smaller: the ParaView 5.11 of Debian 12 cannot read those.
// Debian's expat, since its security update (CVE-2023-52425), reports tokens later than that VTK expects.
// Text in the elements is plain XML that every reader takes.
#ifndef TETLAP_FEM_OUTPUT_VTK_VTU_H
#define TETLAP_FEM_OUTPUT_VTK_VTU_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

// What the cells of a frame are: of a mesh, or of a surface.
typedef enum FemVtuCell { FEM_VTU_TETRAHEDRA, FEM_VTU_TRIANGLES } FemVtuCell;
int fem_vtu_corner_count(FemVtuCell cell);
int fem_vtu_type(FemVtuCell cell); // VTK's number for it

// Values of `count` tuples from tuple `first` on, one after another.
typedef void FemVtuFill(void *self, size_t first, size_t count, double *values);

// One named array over the vertices or the cells; exactly one of `reals`, `integers` and `fill` is given.
// Borrowed.
typedef struct FemVtuArray {
  const char *name;    // as ParaView will show it
  bool is_cell;        // one tuple a cell, else one a vertex
  int components;      // 1; 3: x, y, z; 6: a symmetric tensor xx, yy, zz, xy, yz, xz; 9: row-major
  const double *reals; // written as Float64    (vertex_count or cell_count, components)
  const int *integers; // written as Int32      (vertex_count or cell_count, components)
  FemVtuFill *fill;    // gives reals that are kept nowhere, in turn and some at a time
  void *self;          // of `fill`
} FemVtuArray;

typedef struct FemVtuFrame {
  double time;                // [s]; the field TimeValue; NaN: holds at all times and has no fields
  const double *history_time; // [s]; the field history_time; NULL: there is none
  int vertex_count;
  const double *positions; // current [m]          (vertex_count, 3)
  FemVtuCell cell;
  int cell_count;
  const int *cells;          // vertices                (cell_count, 4 or 3)
  const FemVtuArray *arrays; //                      (array_count)
  int array_count;
} FemVtuFrame;

// Writes the frame whole or not at all. STATUS_IO names the path and the system's reason; STATUS_MEMORY.
// Blocks are compressed in parallel; the bytes do not depend on the number of threads.
// The first rank alone writes.
Status fem_vtu_write(const char *path, const FemVtuFrame *frame);
// Whichever rank calls it.
Status fem_vtu_write_own(const char *path, const FemVtuFrame *frame);

#endif
