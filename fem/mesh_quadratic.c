// SPDX-License-Identifier: GPL-3.0-or-later
// A linear mesh made quadratic: a node in the middle of every edge, every tetrahedron in eight parts.
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/mesh.h"
#include "fem/mesh_validate.h"
#include "fem/quadratic.h"

// A pair of vertices, low < high, of edge `local` of tetrahedron `tet`.
typedef struct Edge {
  int low, high, tet, local;
} Edge;

// What is known of the distinct edges while nodes are added; edge i gets node vertex_count + i.
typedef struct Builder {
  FemMesh *mesh;       // linear still
  Edge *edges;         // all, ordered by ends                  (6 tet_count)
  int *first;          // of each distinct edge in `edges`      (edge_count)
  int edge_count;      // distinct ones
  int (*elements)[10]; //                                       (tet_count)
  bool *on_surface;    // of each distinct edge                 (edge_count)
  bool *skin;          // of each vertex                        (mesh->vertex_count)
} Builder;

static int compare(const void *left, const void *right) {
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->tet > b->tet) - (a->tet < b->tet);
}

static Edge edge_between(int a, int b, int tet, int local) {
  return (Edge){a < b ? a : b, a < b ? b : a, tet, local};
}

static const Edge *edge_at(const Builder *builder, int i) {
  return &builder->edges[builder->first[i]];
}

static Status allocate(Builder *builder) {
  size_t tets = (size_t)builder->mesh->tet_count, vertices = (size_t)builder->mesh->vertex_count;
  builder->edges = memory_zeroed(6 * tets, sizeof *builder->edges);
  builder->first = memory_zeroed(6 * tets, sizeof *builder->first);
  builder->elements = memory_zeroed(tets, sizeof *builder->elements);
  builder->on_surface = memory_zeroed(6 * tets, sizeof *builder->on_surface);
  builder->skin = memory_zeroed(vertices, sizeof *builder->skin);
  bool is_ok = builder->edges && builder->first && builder->elements && builder->on_surface && builder->skin;
  return is_ok ? STATUS_OK : status_no_memory("a quadratic mesh");
}

static void number_edges(Builder *builder) {
  const FemMesh *mesh = builder->mesh;
  int count = 6 * mesh->tet_count;
  for (int e = 0; e < mesh->tet_count; e++) {
    memcpy(builder->elements[e], mesh->tets[e], sizeof mesh->tets[e]);
    for (int k = 0; k < 6; k++)
      builder->edges[6 * e + k] = edge_between(mesh->tets[e][fem_quadratic_edges[k][0]],
                                               mesh->tets[e][fem_quadratic_edges[k][1]], e, k);
  }
  qsort(builder->edges, (size_t)count, sizeof *builder->edges, compare);
  for (int i = 0; i < count; i++) {
    const Edge *edge = &builder->edges[i];
    bool is_new = i == 0 || edge->low != edge[-1].low || edge->high != edge[-1].high;
    if (is_new) builder->first[builder->edge_count++] = i;
    builder->elements[edge->tet][4 + edge->local] = mesh->vertex_count + builder->edge_count - 1;
  }
}

// The distinct edge with these ends, which exists.
static int find_edge(const Builder *builder, int a, int b) {
  Edge sought = edge_between(a, b, 0, 0);
  int low = 0, high = builder->edge_count - 1;
  while (low < high) {
    int middle = low + (high - low) / 2;
    const Edge *edge = edge_at(builder, middle);
    if (edge->low < sought.low || (edge->low == sought.low && edge->high < sought.high))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static Status mark_surface(Builder *builder) {
  int(*triangles)[3], count;
  TRY(fem_mesh_surface(builder->mesh, &triangles, &count));
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) {
      builder->on_surface[find_edge(builder, triangles[i][k], triangles[i][(k + 1) % 3])] = true;
      builder->skin[triangles[i][k]] = true;
    }
  memory_free(triangles);
  return STATUS_OK;
}

// Marks the edges whose middle belongs to a group as both of their ends do. A chord, which runs through the
// inside from surface to surface, belongs to it only with a whole tetrahedron: a group of two opposite faces
// has nothing between them.
static void choose_edges(const Builder *builder, const bool *in_group, bool *is_chosen) {
  const FemMesh *mesh = builder->mesh;
  for (int i = 0; i < builder->edge_count; i++) {
    const Edge *edge = edge_at(builder, i);
    bool is_chord = !builder->on_surface[i] && builder->skin[edge->low] && builder->skin[edge->high];
    is_chosen[i] = in_group[edge->low] && in_group[edge->high] && !is_chord;
  }
  for (int e = 0; e < mesh->tet_count; e++) {
    const int *tet = mesh->tets[e];
    if (!(in_group[tet[0]] && in_group[tet[1]] && in_group[tet[2]] && in_group[tet[3]])) continue;
    for (int k = 4; k < 10; k++) is_chosen[builder->elements[e][k] - mesh->vertex_count] = true;
  }
}

static Status extend_group(const Builder *builder, FemMeshGroup *group, bool *in_group, bool *is_chosen) {
  int vertex_count = builder->mesh->vertex_count, added = 0;
  memset(in_group, 0, (size_t)vertex_count * sizeof *in_group);
  for (int i = 0; i < group->vertex_count; i++) in_group[group->vertices[i]] = true;
  choose_edges(builder, in_group, is_chosen);
  for (int i = 0; i < builder->edge_count; i++) added += is_chosen[i];
  int *all = memory_zeroed((size_t)(group->vertex_count + added), sizeof *all);
  if (!all) return status_no_memory("a quadratic mesh");
  memcpy(all, group->vertices, (size_t)group->vertex_count * sizeof *all);
  for (int i = 0; i < builder->edge_count; i++)
    if (is_chosen[i]) all[group->vertex_count++] = vertex_count + i;
  memory_free(group->vertices);
  group->vertices = all;
  return STATUS_OK;
}

static Status extend_groups(const Builder *builder) {
  bool *in_group = memory_zeroed((size_t)builder->mesh->vertex_count, sizeof *in_group);
  bool *is_chosen = memory_zeroed((size_t)builder->edge_count, sizeof *is_chosen);
  Status status = in_group && is_chosen ? STATUS_OK : status_no_memory("a quadratic mesh");
  for (int g = 0; g < builder->mesh->group_count && !status; g++)
    status = extend_group(builder, &builder->mesh->groups[g], in_group, is_chosen);
  memory_free(in_group);
  memory_free(is_chosen);
  return status;
}

// One part, its order mended so that it is positively oriented. False: it has no volume.
static bool store_part(const double *rest, int part[4], int a, int b, int c, int d) {
  double det = vec3_det4(vec3_at(rest + 3 * (size_t)a), vec3_at(rest + 3 * (size_t)b),
                         vec3_at(rest + 3 * (size_t)c), vec3_at(rest + 3 * (size_t)d));
  part[0] = a, part[1] = b, part[2] = det > 0 ? c : d, part[3] = det > 0 ? d : c;
  return fabs(det) > 0;
}

// Parts 0 … 3 at the corners, 4 … 7 around the shortest diagonal of the octahedron between them.
static Status cut(const double *rest, const int nodes[10], int parts[8][4]) {
  static const int corners[4][4] = {{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}};
  static const int diagonals[3][2] = {{4, 9}, {5, 8}, {6, 7}};
  static const int rings[3][4] = {{5, 6, 8, 7}, {4, 6, 9, 7}, {4, 5, 9, 8}};
  int shortest = 0;
  double length[3];
  for (int d = 0; d < 3; d++) {
    length[d] = vec3_length(vec3_sub(vec3_at(rest + 3 * (size_t)nodes[diagonals[d][0]]),
                                     vec3_at(rest + 3 * (size_t)nodes[diagonals[d][1]])));
    if (length[d] < length[shortest]) shortest = d;
  }
  bool is_ok = true;
  for (int k = 0; k < 4; k++) {
    const int *ring = rings[shortest], *corner = corners[k];
    is_ok =
        store_part(rest, parts[k], nodes[corner[0]], nodes[corner[1]], nodes[corner[2]], nodes[corner[3]]) &&
        store_part(rest, parts[4 + k], nodes[diagonals[shortest][0]], nodes[diagonals[shortest][1]],
                   nodes[ring[k]], nodes[ring[(k + 1) % 4]]) &&
        is_ok;
  }
  if (is_ok) return STATUS_OK;
  const double *x = rest + 3 * (size_t)nodes[0];
  return status_fail(
      STATUS_INPUT,
      "the tetrahedron at (%g, %g, %g) is too flat to be cut into the parts of a quadratic one; "
      "mesh anew",
      x[0], x[1], x[2]);
}

// Puts the quadratic mesh into the place of the linear one.
static Status replace(Builder *builder, double *rest, int (*parts)[4]) {
  FemMesh *mesh = builder->mesh;
  size_t vertices = (size_t)mesh->vertex_count;
  memcpy(rest, mesh->rest, 3 * vertices * sizeof *rest);
  for (int i = 0; i < builder->edge_count; i++) {
    Vec3 low = vec3_at(mesh->rest + 3 * (size_t)edge_at(builder, i)->low),
         high = vec3_at(mesh->rest + 3 * (size_t)edge_at(builder, i)->high);
    vec3_store(rest + 3 * (vertices + (size_t)i), vec3_add(low, vec3_scale(0.5, vec3_sub(high, low))));
  }
  for (int e = 0; e < mesh->tet_count; e++)
    TRY(cut(rest, builder->elements[e], parts + FEM_QUADRATIC_PARTS * (size_t)e));
  memory_free(mesh->rest);
  memory_free(mesh->tets);
  mesh->rest = rest, mesh->vertex_count += builder->edge_count;
  mesh->quadratic = builder->elements, mesh->quadratic_count = mesh->tet_count;
  mesh->tets = parts, mesh->tet_count *= FEM_QUADRATIC_PARTS;
  builder->elements = NULL;
  return STATUS_OK;
}

static Status fill(Builder *builder) {
  size_t nodes = (size_t)builder->mesh->vertex_count + (size_t)builder->edge_count;
  size_t parts_count = FEM_QUADRATIC_PARTS * (size_t)builder->mesh->tet_count;
  double *rest = memory_zeroed(3 * nodes, sizeof *rest);
  int(*parts)[4] = memory_zeroed(parts_count, sizeof *parts);
  Status status = rest && parts ? replace(builder, rest, parts) : status_no_memory("a quadratic mesh");
  if (!status) return STATUS_OK;
  memory_free(rest);
  memory_free(parts);
  return status;
}

static Status build(Builder *builder) {
  TRY(allocate(builder));
  number_edges(builder);
  TRY(mark_surface(builder));
  TRY(extend_groups(builder));
  return fill(builder);
}

Status fem_mesh_make_quadratic(FemMesh *mesh) {
  if (mesh->tet_count > FEM_MESH_MAX_TETS / FEM_QUADRATIC_PARTS)
    return status_fail(STATUS_INPUT,
                       "%d quadratic tetrahedra are more than the %d whose parts this program can number",
                       mesh->tet_count, FEM_MESH_MAX_TETS / FEM_QUADRATIC_PARTS);
  Builder builder = {.mesh = mesh};
  Status status = build(&builder);
  memory_free(builder.edges);
  memory_free(builder.first);
  memory_free(builder.elements);
  memory_free(builder.on_surface);
  memory_free(builder.skin);
  return status;
}
