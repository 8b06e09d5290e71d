// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh from raw arrays, repaired and validated as one that is read.
#pragma once

#include "base/memory.h"
#include "fem/mesh/validate.h"

// Takes copies (0-based). `origin` names the source in messages; `repairs` may be NULL.
static inline Status mesh_from_arrays(FemMesh *mesh, const char *origin, int vertex_count, const double *positions,
                            int tet_count, const int *tets, FemMeshRepairs *repairs) {
  *mesh = (FemMesh){0};
  if (vertex_count < 0 || tet_count < 0)
    return status_fail(STATUS_INPUT, "%s: %d vertices and %d tetrahedra; a count cannot be negative", origin,
                       vertex_count, tet_count);
  FemMeshSource source = {.vertex_count = vertex_count, .tet_count = tet_count};
  source.positions = memory_copy(positions, (size_t)vertex_count, sizeof(double[3]));
  source.tets = memory_copy(tets, (size_t)tet_count, sizeof(int[4]));
  Status status = STATUS_OK;
  if (!source.positions || !source.tets) status = status_no_memory("a mesh");
  if (status == STATUS_OK) status = fem_mesh_validate(mesh, &source, origin, repairs);
  fem_mesh_source_destroy(&source);
  return status;
}
