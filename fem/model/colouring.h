// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra in groups within which no two share a vertex: contributions of a group can be added in parallel,
// and the order of every sum does not depend on the number of threads.
#ifndef TETLAP_FEM_MODEL_COLOURING_H
#define TETLAP_FEM_MODEL_COLOURING_H

#include "base/status.h"

typedef struct FemColouring {
  int colour_count;
  int *begin; // of each colour in `tets`          (colour_count + 1)
  int *tets;  // tetrahedra by colour, ascending within one
} FemColouring;

// Greedy colouring of tetrahedra 0 … tet_count − 1.
Status fem_colouring_create(FemColouring *colouring, int vertex_count, const int (*tets)[4], int tet_count);
void fem_colouring_destroy(FemColouring *colouring);

#endif
