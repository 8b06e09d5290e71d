// SPDX-License-Identifier: GPL-3.0-or-later
// A frame with arrays of its own, to be written while the run goes on. Its memory is used again by the next.
#ifndef TETLAP_FEM_OUTPUT_VTK_VTU_COPY_H
#define TETLAP_FEM_OUTPUT_VTK_VTU_COPY_H

#include <stddef.h>

#include "base/status.h"
#include "fem/output/vtk/vtu.h"

// A zeroed one is empty.
typedef struct FemVtuCopy {
  FemVtuFrame frame; // of what is below; cells and names are borrowed
  double history_time;
  FemVtuArray *arrays;
  double *reals;
  int *integers;
  size_t array_capacity, real_capacity, integer_capacity;
} FemVtuCopy;

// What the arrays of a copy take [bytes].
size_t fem_vtu_copy_bytes(const FemVtuFrame *frame);

// Each `fill` is called by several threads at once. STATUS_MEMORY: the copy does not fit.
Status fem_vtu_copy_take(FemVtuCopy *copy, const FemVtuFrame *frame);
void fem_vtu_copy_destroy(FemVtuCopy *copy);

#endif
