// SPDX-License-Identifier: GPL-3.0-or-later
// The list of a run's frames (.pvd) that ParaView opens as one animation.
#ifndef TETLAP_FEM_PVD_H
#define TETLAP_FEM_PVD_H

#include "base/file.h"
#include "base/status.h"

// Writes a list whole or not at all: begin, an entry a frame, commit (base/file.h, whose failures these are;
// a list that is not committed is abandoned there). `file` is relative to the directory of `path`.
Status fem_pvd_begin(FileWriter *list, const char *path);
void fem_pvd_add(FileWriter *list, double time, const char *file); // [s]
Status fem_pvd_commit(FileWriter *list);

typedef struct FemPvdList {
  double *times; // [s]                                     (count)
  char **files;  // relative to the directory of the list   (count)
  int count;
} FemPvdList;

// Reads such a list; owned by the caller. STATUS_INPUT: it is none; STATUS_IO; STATUS_MEMORY. After a failure
// there is nothing to destroy.
Status fem_pvd_read(const char *path, FemPvdList *list);
void fem_pvd_destroy(FemPvdList *list);

#endif
