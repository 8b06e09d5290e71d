// SPDX-License-Identifier: GPL-3.0-or-later
// Every number of a checkpoint that is not an array: its name in the file, and where it stands in the struct.
// For fem/run/checkpoint/file.c only.
#ifndef TETLAP_FEM_RUN_CHECKPOINT_NUMBERS_H
#define TETLAP_FEM_RUN_CHECKPOINT_NUMBERS_H

#include "fem/run/checkpoint/checkpoint.h"

typedef enum FemCheckpointType { FEM_INTEGER, FEM_LONG, FEM_REAL } FemCheckpointType;

typedef struct FemCheckpointNumber {
  const char *path;
  FemCheckpointType type; // int, long long, double
  size_t offset;          // in FemCheckpoint
  const char *unit;
} FemCheckpointNumber;

const FemCheckpointNumber *fem_checkpoint_numbers(int *count);

#endif
