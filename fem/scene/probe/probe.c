// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/probe/probe.h"

#include <stdbool.h>

#include "base/memory.h"
#include "fem/scene/select.h"

// Keeps the triangles whose corners are all selected.
static Status pick_triangles(FemProbe *probe, const FemMesh *mesh, int vertex_begin) {
  bool *is_selected = memory_zeroed((size_t)mesh->vertex_count, sizeof *is_selected);
  Status status = is_selected ? STATUS_OK : status_no_memory("a probe");
  int count = 0;
  if (!status) status = fem_mesh_surface(mesh, &probe->triangles, &count);
  for (int i = 0; i < probe->vertex_count && !status; i++)
    is_selected[probe->vertices[i] - vertex_begin] = true;
  for (int t = 0; t < count; t++) {
    const int *from = probe->triangles[t];
    if (!is_selected[from[0]] || !is_selected[from[1]] || !is_selected[from[2]]) continue;
    int *to = probe->triangles[probe->triangle_count++];
    for (int k = 0; k < 3; k++) to[k] = vertex_begin + from[k];
  }
  memory_free(is_selected);
  return status;
}

Status fem_probe_create(FemProbe *probe, const FemProbeDef *def, const FemMesh *mesh, int body,
                        int vertex_begin) {
  *probe = (FemProbe){.def = def, .body = body};
  Status status = fem_select_vertices(&def->select, mesh, &probe->vertices, &probe->vertex_count);
  for (int i = 0; i < probe->vertex_count && !status; i++) probe->vertices[i] += vertex_begin;
  if (!status) status = pick_triangles(probe, mesh, vertex_begin);
  if (status) fem_probe_destroy(probe);
  return status;
}

void fem_probe_destroy(FemProbe *probe) {
  memory_free(probe->vertices);
  memory_free(probe->triangles);
  *probe = (FemProbe){0};
}
