// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesh measures: its surface, sizes, angles, parts, and what an analyst should know before using it.
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/tet.h"
#include "base/vec3.h"
#include "fem/mesh/faces.h"
#include "fem/mesh/mesh.h"
#include "fem/mesh/sets.h"

Status fem_mesh_surface(const FemMesh *mesh, int (**triangles)[3], int *triangle_count) {
  FemMeshFace *faces;
  TRY(fem_mesh_faces_list(&faces, mesh->vertex_count, mesh->tet_count, (const int(*)[4])mesh->tets));
  int face_count = 4 * mesh->tet_count, count = 0;
  // The surface's faces move to the front of the list.
  for (int begin = 0, end; begin < face_count; begin = end) {
    end = fem_mesh_faces_end(faces, face_count, begin);
    if (end - begin == 1) faces[count++] = faces[begin];
  }
  int(*list)[3] = memory_zeroed((size_t)count, sizeof *list);
  for (int n = 0; list && n < count; n++)
    for (int k = 0; k < 3; k++) list[n][k] = mesh->tets[faces[n].tet][tet_faces[faces[n].local][k]];
  memory_free(faces);
  if (!list) return status_no_memory("the surface of a mesh");
  *triangles = list;
  *triangle_count = count;
  return STATUS_OK;
}

static Vec3 vertex(const FemMesh *mesh, int v) {
  return vec3_at(mesh->rest + 3 * (size_t)v);
}

// The angle within the tetrahedron at edge a b, between the faces that go on to c and d [rad].
static double dihedral(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  Vec3 edge = vec3_sub(b, a);
  Vec3 m = vec3_cross(edge, vec3_sub(c, a)), n = vec3_cross(edge, vec3_sub(d, a));
  return atan2(vec3_length(vec3_cross(m, n)), vec3_dot(m, n));
}

static void measure_tet(const FemMesh *mesh, int t, FemMeshQuality *quality) {
  // Edge e joins corners e0 and e1; e2 and e3 are the other two.
  static const int edges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                  {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  const double degrees = 180 / acos(-1);
  Vec3 p[4];
  for (int k = 0; k < 4; k++) p[k] = vertex(mesh, mesh->tets[t][k]);
  double longest = 0;
  for (int e = 0; e < 6; e++) {
    const int *k = edges[e];
    longest = fmax(longest, vec3_length(vec3_sub(p[k[1]], p[k[0]])));
    double angle = degrees * dihedral(p[k[0]], p[k[1]], p[k[2]], p[k[3]]);
    quality->max_dihedral_degrees = fmax(quality->max_dihedral_degrees, angle);
    if (angle < quality->min_dihedral_degrees)
      quality->min_dihedral_degrees = angle, quality->min_dihedral_tet = t;
  }
  double det = vec3_det4(p[0], p[1], p[2], p[3]), shape = det / (longest * longest * longest);
  quality->volume += det / 6;
  if (shape < quality->min_det) quality->min_det = shape, quality->min_det_tet = t;
}

double fem_mesh_min_dihedral(const FemMesh *mesh) {
  FemMeshQuality quality = {.min_dihedral_degrees = INFINITY, .min_det = INFINITY};
  for (int t = 0; t < mesh->tet_count; t++) measure_tet(mesh, t, &quality);
  return quality.min_dihedral_degrees;
}

static void measure_box(const FemMesh *mesh, FemMeshQuality *quality) {
  for (int c = 0; c < 3; c++) quality->box_min[c] = INFINITY, quality->box_max[c] = -INFINITY;
  for (int v = 0; v < mesh->vertex_count; v++)
    for (int c = 0; c < 3; c++) {
      double x = mesh->rest[3 * (size_t)v + (size_t)c];
      quality->box_min[c] = fmin(quality->box_min[c], x), quality->box_max[c] = fmax(quality->box_max[c], x);
    }
}

static int compare_pair(const void *left, const void *right) {
  const int *a = left, *b = right;
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

static Status measure_edges(const FemMesh *mesh, FemMeshQuality *quality) {
  int(*edges)[2] = memory_zeroed(6 * (size_t)mesh->tet_count, sizeof *edges);
  if (!edges) return status_no_memory("the edges of a mesh");
  size_t count = 0;
  for (int t = 0; t < mesh->tet_count; t++)
    for (int k = 1; k < 4; k++)
      for (int m = 0; m < k; m++) {
        int a = mesh->tets[t][k], b = mesh->tets[t][m];
        edges[count][0] = a < b ? a : b, edges[count][1] = a < b ? b : a;
        count++;
      }
  qsort(edges, count, sizeof *edges, compare_pair);
  double sum = 0;
  size_t distinct = 0;
  quality->min_edge = INFINITY;
  for (size_t e = 0; e < count; e++) {
    if (e > 0 && compare_pair(edges[e], edges[e - 1]) == 0) continue;
    double length = vec3_length(vec3_sub(vertex(mesh, edges[e][1]), vertex(mesh, edges[e][0])));
    sum += length, distinct++;
    quality->min_edge = fmin(quality->min_edge, length), quality->max_edge = fmax(quality->max_edge, length);
  }
  quality->mean_edge = sum / (double)distinct;
  memory_free(edges);
  return STATUS_OK;
}

static Status count_components(const FemMesh *mesh, FemMeshQuality *quality) {
  int *parent = fem_mesh_sets_new(mesh->vertex_count);
  if (!parent) return status_no_memory("the parts of a mesh");
  quality->component_count = mesh->vertex_count;
  for (int t = 0; t < mesh->tet_count; t++)
    for (int k = 1; k < 4; k++)
      if (fem_mesh_sets_join(parent, mesh->tets[t][0], mesh->tets[t][k])) quality->component_count--;
  memory_free(parent);
  return STATUS_OK;
}

// Positions in lexicographic order; −0 equals 0.
static int compare_position(const void *left, const void *right) {
  const double *a = left, *b = right;
  for (int c = 0; c < 3; c++)
    if (a[c] != b[c]) return a[c] < b[c] ? -1 : 1;
  return 0;
}

Status fem_mesh_coincident(const double *positions, int count, int *coincident_count) {
  double(*sorted)[3] = memory_copy(positions, (size_t)count, sizeof *sorted);
  *coincident_count = 0;
  if (!sorted) return status_no_memory("the vertices of a mesh");
  qsort(sorted, (size_t)count, sizeof *sorted, compare_position);
  for (int v = 1; v < count; v++)
    if (compare_position(sorted[v - 1], sorted[v]) == 0) (*coincident_count)++;
  memory_free(sorted);
  return STATUS_OK;
}

// A corner of a surface triangle seen along one of its edges: edge (low, high), the corners at its two ends.
typedef struct SurfaceEdge {
  int low, high;
  int low_corner, high_corner; // 3 · triangle + place
} SurfaceEdge;

static int compare_edge(const void *left, const void *right) {
  const SurfaceEdge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  return (a->high > b->high) - (a->high < b->high);
}

static void fill_surface_edges(SurfaceEdge *edges, int (*triangles)[3], int count) {
  for (int n = 0; n < count; n++)
    for (int k = 0; k < 3; k++) {
      int next = (k + 1) % 3, a = triangles[n][k], b = triangles[n][next];
      SurfaceEdge ab = {a, b, 3 * n + k, 3 * n + next}, ba = {b, a, 3 * n + next, 3 * n + k};
      edges[3 * n + k] = a < b ? ab : ba;
    }
}

// Around an ordinary vertex the corners of its surface triangles form one fan, joined across edges. Several
// fans mean that the surface touches itself there.
static void count_pinches(const SurfaceEdge *edges, int edge_count, int (*triangles)[3], int *fans,
                          int *first, FemMeshQuality *quality) {
  for (int begin = 0, end; begin < edge_count; begin = end) {
    for (end = begin + 1; end < edge_count && compare_edge(&edges[begin], &edges[end]) == 0; end++) {
      fem_mesh_sets_join(fans, edges[begin].low_corner, edges[end].low_corner);
      fem_mesh_sets_join(fans, edges[begin].high_corner, edges[end].high_corner);
    }
    if (end - begin > 2) quality->pinch_edge_count++;
  }
  // first[v]: 1 + the fan that v was first seen in, −1 once it is counted.
  for (int corner = 0; corner < edge_count; corner++) {
    int v = triangles[corner / 3][corner % 3], fan = 1 + fem_mesh_sets_find(fans, corner);
    if (first[v] == 0) first[v] = fan;
    if (first[v] < 0 || first[v] == fan) continue;
    first[v] = -1;
    quality->pinch_vertex_count++;
  }
}

static Status measure_surface(const FemMesh *mesh, FemMeshQuality *quality) {
  int(*triangles)[3], count;
  TRY(fem_mesh_surface(mesh, &triangles, &count));
  SurfaceEdge *edges = memory_zeroed(3 * (size_t)count, sizeof *edges);
  int *fans = fem_mesh_sets_new(3 * count), *first = memory_zeroed((size_t)mesh->vertex_count, sizeof *first);
  Status status = STATUS_OK;
  if (edges && fans && first) {
    quality->surface_triangle_count = count;
    for (int n = 0; n < count; n++) {
      Vec3 a = vertex(mesh, triangles[n][0]);
      Vec3 u = vec3_sub(vertex(mesh, triangles[n][1]), a), v = vec3_sub(vertex(mesh, triangles[n][2]), a);
      quality->surface_area += 0.5 * vec3_length(vec3_cross(u, v));
    }
    fill_surface_edges(edges, triangles, count);
    qsort(edges, 3 * (size_t)count, sizeof *edges, compare_edge);
    count_pinches(edges, 3 * count, triangles, fans, first, quality);
  } else {
    status = status_no_memory("the surface of a mesh");
  }
  memory_free(triangles), memory_free(edges), memory_free(fans), memory_free(first);
  return status;
}

Status fem_mesh_quality(const FemMesh *mesh, FemMeshQuality *quality) {
  *quality = (FemMeshQuality){.min_dihedral_degrees = INFINITY, .min_det = INFINITY};
  for (int t = 0; t < mesh->tet_count; t++) measure_tet(mesh, t, quality);
  measure_box(mesh, quality);
  TRY(measure_edges(mesh, quality));
  TRY(count_components(mesh, quality));
  TRY(fem_mesh_coincident(mesh->rest, mesh->vertex_count, &quality->coincident_vertex_count));
  return measure_surface(mesh, quality);
}
