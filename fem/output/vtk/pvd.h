// SPDX-License-Identifier: GPL-3.0-or-later
// The list of a run's frames (.pvd) that ParaView opens as one animation.
#ifndef TETLAP_FEM_OUTPUT_VTK_PVD_H
#define TETLAP_FEM_OUTPUT_VTK_PVD_H

#include "base/files/file.h"
#include "base/status.h"

// Writes a list whole or not at all: begin, the entries, commit (base/files/file.h, whose failures these are;
// a list that is not committed is abandoned there).
Status fem_pvd_begin(FileWriter *list, const char *path);
// `part` 0, 1 … of the frame at a time [s], the same ones at each; `name` is what ParaView calls it, NULL:
// nothing. `file` is relative to the list's directory and may stand at many times.
void fem_pvd_add(FileWriter *list, double time, int part, const char *name, const char *file);
Status fem_pvd_commit(FileWriter *list);

typedef struct FemPvdList {
  int count;      // of times
  int part_count; // files at each of them
  double *times;  // [s]                                     (count)
  char **files;   // relative to the directory of the list   (count, part_count)
} FemPvdList;

// Reads such a list; owned by the caller. STATUS_INPUT: it is none, or times have other parts than the first;
// STATUS_IO; STATUS_MEMORY. After a failure there is nothing to destroy.
Status fem_pvd_read(const char *path, FemPvdList *list);
void fem_pvd_destroy(FemPvdList *list);

#endif
