// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/validate.h"

#include <float.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/mesh/faces.h"
#include "fem/mesh/middles.h"

// 6 V of an element with longest edge L is taken for zero below FLATNESS · L³, or where the rounding of
// coordinates of size M could have made it: below PLACE_ROUNDING · M · L².
static const double FLATNESS = 1e-12, PLACE_ROUNDING = 8 * DBL_EPSILON;

static long long tet_tag(const FemMeshSource *source, int tet) {
  return source->tet_tags ? source->tet_tags[tet] : tet;
}

static long long vertex_tag(const FemMeshSource *source, int vertex) {
  return source->vertex_tags ? source->vertex_tags[vertex] : vertex;
}

static Vec3 corner(const FemMeshSource *source, int tet, int k) {
  return vec3_at(source->positions + 3 * (size_t)source->tets[tet][k]);
}

static Vec3 centroid(const FemMeshSource *source, int tet) {
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < 4; k++) sum = vec3_add(sum, corner(source, tet, k));
  return vec3_scale(0.25, sum);
}

static Status check_counts(const FemMeshSource *source) {
  if (source->tet_count < 1)
    return status_fail(STATUS_INPUT, "has no tetrahedra; give a volume mesh of tetrahedra");
  if (source->vertex_count < 4)
    return status_fail(STATUS_INPUT, "has %d vertices; a tetrahedron needs four", source->vertex_count);
  if (source->vertex_count > FEM_MESH_MAX_VERTICES || source->tet_count > FEM_MESH_MAX_TETS)
    return status_fail(STATUS_INPUT,
                       "%d vertices and %d tetrahedra are more than the %d this program can number",
                       source->vertex_count, source->tet_count, FEM_MESH_MAX_TETS);
  return STATUS_OK;
}

static Status check_positions(const FemMeshSource *source) {
  for (int v = 0; v < source->vertex_count; v++) {
    const double *x = source->positions + 3 * (size_t)v;
    if (!(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2])))
      return status_fail(
          STATUS_INPUT, "vertex %lld has the position (%g, %g, %g); every coordinate must be a finite number",
          vertex_tag(source, v), x[0], x[1], x[2]);
  }
  return STATUS_OK;
}

static Status check_indices(const FemMeshSource *source) {
  int count = source->middles ? 10 : 4;
  for (int t = 0; t < source->tet_count; t++) {
    int nodes[10];
    memcpy(nodes, source->tets[t], sizeof source->tets[t]);
    if (source->middles) memcpy(nodes + 4, source->middles[t], sizeof source->middles[t]);
    for (int k = 0; k < count; k++)
      if (nodes[k] < 0 || nodes[k] >= source->vertex_count)
        return status_fail(STATUS_INPUT,
                           "element %lld refers to vertex %d, but there are only the vertices %lld to %lld",
                           tet_tag(source, t), nodes[k], vertex_tag(source, 0),
                           vertex_tag(source, source->vertex_count - 1));
    for (int k = 0; k < count; k++)
      for (int m = 0; m < k; m++)
        if (nodes[k] == nodes[m])
          return status_fail(
              STATUS_INPUT,
              "element %lld has vertex %lld twice; remove the element or give it %s different vertices",
              tet_tag(source, t), vertex_tag(source, nodes[k]), count == 4 ? "four" : "ten");
  }
  return STATUS_OK;
}

// Whether the element has no volume that its coordinates could vouch for; NaN counts as flat.
static bool is_flat(const FemMeshSource *source, int tet, double det) {
  double longest = 0, size = 0;
  for (int k = 0; k < 4; k++) {
    Vec3 p = corner(source, tet, k);
    size = fmax(size, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    for (int m = 0; m < k; m++) longest = fmax(longest, vec3_length(vec3_sub(p, corner(source, tet, m))));
  }
  double square = longest * longest;
  return !(fabs(det) > fmax(FLATNESS * longest, PLACE_ROUNDING * size) * square);
}

static void swap(int *a, int *b) {
  int kept = *a;
  *a = *b, *b = kept;
}

// Exchanges corners 2 and 3, and so the edges 02 and 03, 12 and 13.
static void turn_over(FemMeshSource *source, int tet) {
  swap(&source->tets[tet][2], &source->tets[tet][3]);
  if (!source->middles) return;
  swap(&source->middles[tet][1], &source->middles[tet][2]);
  swap(&source->middles[tet][3], &source->middles[tet][4]);
}

static Status orient(FemMeshSource *source, int *reoriented) {
  for (int t = 0; t < source->tet_count; t++) {
    double det =
        vec3_det4(corner(source, t, 0), corner(source, t, 1), corner(source, t, 2), corner(source, t, 3));
    if (is_flat(source, t, det)) {
      Vec3 c = centroid(source, t);
      return status_fail(STATUS_INPUT,
                         "element %lld at (%g, %g, %g) has zero volume (6 V = %.3g); remove it or mesh anew",
                         tet_tag(source, t), c.x, c.y, c.z, det);
    }
    if (det > 0) continue;
    turn_over(source, t);
    ++*reoriented;
  }
  return STATUS_OK;
}

static bool have_same_vertices(const int a[4], const int b[4]) {
  for (int k = 0; k < 4; k++)
    if (a[k] != b[0] && a[k] != b[1] && a[k] != b[2] && a[k] != b[3]) return false;
  return true;
}

// The tetrahedra at one triangle: at most two, on opposite sides.
static Status check_face(const FemMeshSource *source, const FemMeshFace *faces, int count) {
  for (int k = 1; k < count; k++)
    for (int m = 0; m < k; m++)
      if (have_same_vertices(source->tets[faces[k].tet], source->tets[faces[m].tet]))
        return status_fail(STATUS_INPUT,
                           "elements %lld and %lld have the same four vertices; remove one of them",
                           tet_tag(source, faces[m].tet), tet_tag(source, faces[k].tet));
  const int *v = faces->vertices;
  if (count > 2)
    return status_fail(
        STATUS_INPUT,
        "the triangle of vertices %lld, %lld, %lld belongs to %d elements (%lld, %lld, %lld%s); at "
        "most two can share it: remove the overlapping ones",
        vertex_tag(source, v[0]), vertex_tag(source, v[1]), vertex_tag(source, v[2]), count,
        tet_tag(source, faces[0].tet), tet_tag(source, faces[1].tet), tet_tag(source, faces[2].tet),
        count > 3 ? ", …" : "");
  if (count == 2 && faces[0].is_even == faces[1].is_even)
    return status_fail(
        STATUS_INPUT,
        "elements %lld and %lld lie on the same side of their common triangle (vertices %lld, %lld, "
        "%lld) and so overlap; remove one of them or mesh anew",
        tet_tag(source, faces[0].tet), tet_tag(source, faces[1].tet), vertex_tag(source, v[0]),
        vertex_tag(source, v[1]), vertex_tag(source, v[2]));
  return STATUS_OK;
}

static Status check_faces(const FemMeshSource *source) {
  FemMeshFace *faces;
  TRY(fem_mesh_faces_list(&faces, source->vertex_count, source->tet_count, (const int(*)[4])source->tets));
  int face_count = 4 * source->tet_count;
  Status status = STATUS_OK;
  for (int begin = 0, end; begin < face_count && status == STATUS_OK; begin = end) {
    end = fem_mesh_faces_end(faces, face_count, begin);
    status = check_face(source, faces + begin, end - begin);
  }
  memory_free(faces);
  return status;
}

static int compare_int(const void *left, const void *right) {
  int a = *(const int *)left, b = *(const int *)right;
  return (a > b) - (a < b);
}

// Sorts, and keeps one of each; returns how many there are then.
static int sort_distinct(int *list, int count) {
  if (count > 0) qsort(list, (size_t)count, sizeof *list, compare_int); // an empty list may be NULL
  int distinct = 0;
  for (int k = 0; k < count; k++)
    if (distinct == 0 || list[k] != list[distinct - 1]) list[distinct++] = list[k];
  return distinct;
}

// The group's edges, from its vertices in the numbers of the file.
static Status take_middles(FemMeshGroup *group, const int *edge_of_vertex) {
  group->middles = memory_zeroed((size_t)group->vertex_count, sizeof *group->middles);
  if (!group->middles) return status_no_memory("the groups of a mesh");
  for (int k = 0; k < group->vertex_count; k++) {
    int edge = edge_of_vertex[group->vertices[k]];
    if (edge >= 0) group->middles[group->middle_count++] = edge;
  }
  group->middle_count = sort_distinct(group->middles, group->middle_count);
  return STATUS_OK;
}

static void renumber_group(FemMeshGroup *group, const int *new_index) {
  int kept = 0;
  for (int k = 0; k < group->vertex_count; k++) {
    int vertex = new_index[group->vertices[k]];
    if (vertex >= 0) group->vertices[kept++] = vertex;
  }
  group->vertex_count = sort_distinct(group->vertices, kept);
  group->tet_count = sort_distinct(group->tets, group->tet_count);
}

// Keeps the corners in their order, in place.
static Status keep_corners(FemMeshSource *source, const FemMeshMiddles *middles, int *dropped) {
  int *new_index = memory_zeroed((size_t)source->vertex_count, sizeof *new_index);
  if (!new_index) return status_no_memory("the vertex numbers of a mesh");
  for (int t = 0; t < source->tet_count; t++)
    for (int k = 0; k < 4; k++) new_index[source->tets[t][k]] = 1;
  int used = 0;
  for (int v = 0; v < source->vertex_count; v++) {
    if (!new_index[v]) {
      new_index[v] = -1;
      continue;
    }
    memmove(source->positions + 3 * (size_t)used, source->positions + 3 * (size_t)v, 3 * sizeof(double));
    new_index[v] = used++;
  }
  for (int t = 0; t < source->tet_count; t++)
    for (int k = 0; k < 4; k++) source->tets[t][k] = new_index[source->tets[t][k]];
  for (int g = 0; g < source->group_count; g++) renumber_group(&source->groups[g], new_index);
  memory_free(new_index);
  *dropped = source->vertex_count - used - middles->edge_count;
  source->vertex_count = used;
  return STATUS_OK;
}

static Status check_and_mend(FemMeshSource *source, FemMeshMiddles *middles, FemMeshRepairs *mended) {
  TRY(check_counts(source));
  TRY(check_positions(source));
  TRY(check_indices(source));
  TRY(orient(source, &mended->reoriented_tets));
  TRY(check_faces(source));
  if (source->middles) {
    TRY(fem_mesh_middles_number(middles, source));
    for (int g = 0; g < source->group_count; g++)
      TRY(take_middles(&source->groups[g], middles->edge_of_vertex));
  }
  return keep_corners(source, middles, &mended->dropped_vertices);
}

Status fem_mesh_validate(FemMesh *mesh, FemMeshSource *source, const char *origin, FemMeshRepairs *repairs) {
  FemMeshRepairs mended = {0};
  *mesh = (FemMesh){0};
  FemMeshMiddles middles = {0};
  Status status = check_and_mend(source, &middles, &mended);
  if (status != STATUS_OK) {
    fem_mesh_middles_destroy(&middles);
    return status_prefix(status, "%s", origin);
  }
  *mesh = (FemMesh){.vertex_count = source->vertex_count,
                    .tet_count = source->tet_count,
                    .rest = source->positions,
                    .tets = source->tets,
                    .groups = source->groups,
                    .group_count = source->group_count,
                    .middles = middles.rest,
                    .edge_count = middles.edge_count};
  middles.rest = NULL;
  fem_mesh_middles_destroy(&middles);
  if (mesh->middles) mesh->tet_tags = source->tet_tags, source->tet_tags = NULL;
  source->positions = NULL, source->tets = NULL, source->groups = NULL, source->group_count = 0;
  if (repairs) *repairs = mended;
  return STATUS_OK;
}

void fem_mesh_source_destroy(FemMeshSource *source) {
  for (int g = 0; g < source->group_count; g++) fem_mesh_group_destroy(&source->groups[g]);
  memory_free(source->groups);
  memory_free(source->positions), memory_free(source->tets), memory_free(source->middles);
  memory_free(source->vertex_tags), memory_free(source->tet_tags);
  *source = (FemMeshSource){0};
}
