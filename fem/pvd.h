// SPDX-License-Identifier: GPL-3.0-or-later
// The list of a run's frames (.pvd) that ParaView opens as one animation.
#ifndef TETLAP_FEM_PVD_H
#define TETLAP_FEM_PVD_H

#include "base/status.h"

// Writes the list of `count` frames whole or not at all; called again after every frame, so that a run that
// was stopped, or still runs, can be looked at. `files` are relative to the directory of `path`; times [s].
Status fem_pvd_write(const char *path, const double *times, const char *const *files, int count);

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
