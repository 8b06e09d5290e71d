// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/curve.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/smooth/smooth_points.h"
#include "fem/mesh/edges.h"

static Vec3 middle_of(const FemMesh *mesh, const ContactSmooth *smooth, int low, int high) {
  int edge = contact_skin_edge(&smooth->skin, low, high);
  if (edge >= 0 && smooth->is_curved[edge])
    return contact_smooth_points_place(smooth, mesh->vertex_count + smooth->edge_points[edge]);
  Vec3 ends[2] = {vec3_at(mesh->rest + 3 * (size_t)low), vec3_at(mesh->rest + 3 * (size_t)high)};
  return vec3_scale(0.5, vec3_add(ends[0], ends[1]));
}

static void place_middles(FemMesh *mesh, const ContactSmooth *smooth, const FemMeshEdge *edges) {
  int count = 6 * mesh->tet_count;
  for (int begin = 0; begin < count; begin = fem_mesh_edges_end(edges, count, begin))
    vec3_store(mesh->middles + 3 * (size_t)mesh->edge_count++,
               middle_of(mesh, smooth, edges[begin].low, edges[begin].high));
}

static Status place_all(FemMesh *mesh, const ContactSmooth *smooth) {
  FemMeshEdge *edges;
  TRY(fem_mesh_edges_list(&edges, mesh->tet_count, (const int(*)[4])mesh->tets));
  mesh->middles = memory_zeroed(6 * (size_t)mesh->tet_count, sizeof(double[3]));
  if (mesh->middles) place_middles(mesh, smooth, edges);
  memory_free(edges);
  return mesh->middles ? STATUS_OK : status_no_memory("the curved edges of a mesh");
}

Status fem_mesh_curve(FemMesh *mesh, double crease) {
  if (mesh->middles) return STATUS_OK;
  ContactSystemDef def = {.vertex_count = mesh->vertex_count,
                          .rest = mesh->rest,
                          .tets = (const int(*)[4])mesh->tets,
                          .tet_count = mesh->tet_count};
  ContactBody body = {.vertex_end = mesh->vertex_count, .tet_end = mesh->tet_count};
  ContactSmooth smooth = {0};
  Status status = contact_smooth_points_create(&smooth, &def, &body, 1, crease * M_PI / 180);
  if (!status) status = place_all(mesh, &smooth);
  contact_smooth_points_destroy(&smooth);
  return status;
}
