// SPDX-License-Identifier: GPL-3.0-or-later
// Where a run starts that goes on from the end state of another: what its bodies bring with them. At rest a
// model has none. What is prescribed starts from there, too: fixed vertices stay where they are,
// displacements and turns of driven ones count from there.
#ifndef TETLAP_FEM_MODEL_START_H
#define TETLAP_FEM_MODEL_START_H

#include <stddef.h>

#include "base/status.h"

enum { FEM_START_NAME = 32, FEM_START_HISTORIES = 2 };

// What an effect remembers, in that effect's own layout.
typedef struct FemStartHistory {
  char effect[FEM_START_NAME];
  double *values; // owned                                            (count)
  size_t count;
} FemStartHistory;

typedef struct FemStart {
  double time;          // of the end state, in its own run [s]
  double *displacement; // from rest; of obstacles 0 [m], owned           (vertex_count, 3)
  double *positions;    // [m], owned                                     (vertex_count, 3)
  char *interfaces;     // those that friction's history numbers, a line "A, B" each; owned
  FemStartHistory histories[FEM_START_HISTORIES];
  int history_count;
} FemStart;

void fem_model_start_destroy(FemStart *start); // NULL: nothing

#endif
