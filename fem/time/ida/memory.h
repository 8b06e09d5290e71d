// SPDX-License-Identifier: GPL-3.0-or-later
// IDA's memory, made and set up for a system.
#ifndef TETLAP_FEM_TIME_IDA_MEMORY_H
#define TETLAP_FEM_TIME_IDA_MEMORY_H

#include "fem/time/ida/ida.h"

typedef struct FemIdaDef {
  FemSystem *system; // borrowed
  FemState *state;   // that each evaluation fills, borrowed
  const FemSolverOps *solver;
  FemErrorTolerance tolerance;
  int max_order;
  double min_step, max_step; // [s]
} FemIdaDef;

// One whose creation failed can be destroyed.
Status fem_ida_memory_create(FemIda *ida, const FemIdaDef *def);
void fem_ida_memory_destroy(FemIda *ida);

#endif
