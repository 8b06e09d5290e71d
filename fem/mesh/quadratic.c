// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh made quadratic: a node on every edge, every tetrahedron in eight parts.
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/element/quadratic.h"
#include "fem/mesh/edges.h"
#include "fem/mesh/mesh.h"
#include "fem/mesh/validate.h"

// What is known of the distinct edges while nodes are added; edge i gets node vertex_count + i.
typedef struct Builder {
  FemMesh *mesh;       // linear still
  FemMeshEdge *edges;  // all, ordered by ends                  (6 tet_count)
  int *first;          // of each distinct edge in `edges`      (edge_count)
  int edge_count;      // distinct ones
  int (*elements)[10]; //                                       (tet_count)
  bool *on_surface;    // of each distinct edge                 (edge_count)
  bool *skin;          // of each vertex                        (mesh->vertex_count)
} Builder;

static const FemMeshEdge *edge_at(const Builder *builder, int i) {
  return &builder->edges[builder->first[i]];
}

static Status allocate(Builder *builder) {
  size_t tets = (size_t)builder->mesh->tet_count, vertices = (size_t)builder->mesh->vertex_count;
  builder->first = memory_zeroed(6 * tets, sizeof *builder->first);
  builder->elements = memory_zeroed(tets, sizeof *builder->elements);
  builder->on_surface = memory_zeroed(6 * tets, sizeof *builder->on_surface);
  builder->skin = memory_zeroed(vertices, sizeof *builder->skin);
  bool is_ok = builder->first && builder->elements && builder->on_surface && builder->skin;
  return is_ok ? STATUS_OK : status_no_memory("a quadratic mesh");
}

static void number_edges(Builder *builder) {
  const FemMesh *mesh = builder->mesh;
  int count = 6 * mesh->tet_count;
  for (int e = 0; e < mesh->tet_count; e++) memcpy(builder->elements[e], mesh->tets[e], sizeof mesh->tets[e]);
  for (int begin = 0, end; begin < count; begin = end) {
    end = fem_mesh_edges_end(builder->edges, count, begin);
    for (int i = begin; i < end; i++)
      builder->elements[builder->edges[i].tet][4 + builder->edges[i].local] =
          mesh->vertex_count + builder->edge_count;
    builder->first[builder->edge_count++] = begin;
  }
}

// The distinct edge with these ends, which exists.
static int find_edge(const Builder *builder, int a, int b) {
  int lower = a < b ? a : b, upper = a < b ? b : a;
  int low = 0, high = builder->edge_count - 1;
  while (low < high) {
    int middle = low + (high - low) / 2;
    const FemMeshEdge *edge = edge_at(builder, middle);
    if (edge->low < lower || (edge->low == lower && edge->high < upper))
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

// Marks the edges whose middle belongs to a group as both of their ends do, where no file says more. A chord,
// which runs through the inside from surface to surface, belongs to it only with a whole tetrahedron: a group
// of two opposite faces has nothing between them.
static void choose_edges(const Builder *builder, const bool *in_group, bool *is_chosen) {
  const FemMesh *mesh = builder->mesh;
  for (int i = 0; i < builder->edge_count; i++) {
    const FemMeshEdge *edge = edge_at(builder, i);
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
  if (group->middle_count > 0) {
    memset(is_chosen, 0, (size_t)builder->edge_count * sizeof *is_chosen);
    for (int i = 0; i < group->middle_count; i++) is_chosen[group->middles[i]] = true;
  } else {
    choose_edges(builder, in_group, is_chosen);
  }
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

// False: the part has no volume, or is inside out.
static bool store_part(const double *rest, int part[4], int a, int b, int c, int d) {
  part[0] = a, part[1] = b, part[2] = c, part[3] = d;
  return vec3_det4(vec3_at(rest + 3 * (size_t)a), vec3_at(rest + 3 * (size_t)b),
                   vec3_at(rest + 3 * (size_t)c), vec3_at(rest + 3 * (size_t)d)) > 0;
}

// Parts 0 … 3 at the corners, 4 … 7 around the shortest diagonal of the octahedron between them.
static bool cut(const double *rest, const int nodes[10], int parts[8][4]) {
  static const int corners[4][4] = {{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}};
  static const int diagonals[3][2] = {{4, 9}, {5, 8}, {6, 7}};
  static const int rings[3][4] = {{5, 6, 8, 7}, {6, 4, 7, 9}, {4, 5, 9, 8}};
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
  return is_ok;
}

// Where a curved element is inside out at a point of integration its material would have no state to begin
// with; where a part is, contact would take the body for its outside.
static Status check_shape(const Builder *builder, int e, const double *rest, bool is_cut) {
  const FemMesh *mesh = builder->mesh;
  double nodes[30], jacobian = 1;
  for (int k = 0; k < FEM_QUADRATIC_NODES; k++)
    memcpy(nodes + 3 * k, rest + 3 * (size_t)builder->elements[e][k], 3 * sizeof *nodes);
  if (mesh->middles) jacobian = fem_quadratic_min_jacobian(nodes);
  if (is_cut && jacobian > 0) return STATUS_OK;
  if (!mesh->middles)
    return status_fail(
        STATUS_INPUT,
        "the tetrahedron at (%g, %g, %g) is too flat to be cut into the parts of a quadratic one; mesh anew",
        nodes[0], nodes[1], nodes[2]);
  return status_fail(
      STATUS_INPUT,
      "element %lld at (%g, %g, %g) is so curved that it is inverted (%s); mesh finer or straight, "
      "or give the body element: linear, which takes the corners alone",
      mesh->tet_tags ? mesh->tet_tags[e] : e, nodes[0], nodes[1], nodes[2],
      jacobian > 0 ? "one of the eight parts that contact sees" : "at a point of integration");
}

// The nodes on edges, `middles` (edge_count, 3).
static void place_nodes(const Builder *builder, double *middles) {
  const FemMesh *mesh = builder->mesh;
  for (int i = 0; i < builder->edge_count; i++) {
    Vec3 low = vec3_at(mesh->rest + 3 * (size_t)edge_at(builder, i)->low),
         high = vec3_at(mesh->rest + 3 * (size_t)edge_at(builder, i)->high);
    vec3_store(middles + 3 * (size_t)i, vec3_add(low, vec3_scale(0.5, vec3_sub(high, low))));
  }
  if (mesh->middles) memcpy(middles, mesh->middles, (size_t)builder->edge_count * sizeof(double[3]));
}

// Puts the quadratic mesh into the place of the linear one.
static Status replace(Builder *builder, double *rest, int (*parts)[4]) {
  FemMesh *mesh = builder->mesh;
  size_t vertices = (size_t)mesh->vertex_count;
  memcpy(rest, mesh->rest, 3 * vertices * sizeof *rest);
  place_nodes(builder, rest + 3 * vertices);
  for (int e = 0; e < mesh->tet_count; e++)
    TRY(check_shape(builder, e, rest,
                    cut(rest, builder->elements[e], parts + FEM_QUADRATIC_PARTS * (size_t)e)));
  memory_free(mesh->rest);
  memory_free(mesh->tets);
  mesh->rest = rest, mesh->vertex_count += builder->edge_count;
  mesh->quadratic = builder->elements, mesh->quadratic_count = mesh->tet_count;
  mesh->tets = parts, mesh->tet_count *= FEM_QUADRATIC_PARTS;
  builder->elements = NULL;
  fem_mesh_make_linear(mesh); // its nodes on edges are vertices now
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
  TRY(fem_mesh_edges_list(&builder->edges, builder->mesh->tet_count, (const int(*)[4])builder->mesh->tets));
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
