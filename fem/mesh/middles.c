// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/middles.h"

#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/element/quadratic.h"
#include "fem/mesh/edges.h"

// In edge_of_vertex while edges are numbered: the vertex is nothing yet, or a corner.
enum { NOTHING = -1, CORNER = -2 };

static long long tet_tag(const FemMeshSource *source, int tet) {
  return source->tet_tags ? source->tet_tags[tet] : tet;
}

static long long vertex_tag(const FemMeshSource *source, int vertex) {
  return source->vertex_tags ? source->vertex_tags[vertex] : vertex;
}

static int node_of(const FemMeshSource *source, const FemMeshEdge *edge) {
  return source->middles[edge->tet][edge->local];
}

// Takes the node of one edge, which its tetrahedra, edges[0] … edges[count − 1], must agree on.
static Status take_edge(FemMeshMiddles *middles, const FemMeshSource *source, const FemMeshEdge *edges,
                        int count) {
  int node = node_of(source, edges), *edge = &middles->edge_of_vertex[node];
  for (int k = 1; k < count; k++)
    if (node_of(source, &edges[k]) != node)
      return status_fail(
          STATUS_INPUT,
          "elements %lld and %lld have different nodes, %lld and %lld, on the edge between vertices %lld and "
          "%lld; merge them, or export it again",
          tet_tag(source, edges[0].tet), tet_tag(source, edges[k].tet), vertex_tag(source, node),
          vertex_tag(source, node_of(source, &edges[k])), vertex_tag(source, edges[0].low),
          vertex_tag(source, edges[0].high));
  if (*edge != NOTHING)
    return status_fail(
        STATUS_INPUT,
        "vertex %lld, the node between vertices %lld and %lld in element %lld, is %s elsewhere; "
        "mesh anew",
        vertex_tag(source, node), vertex_tag(source, edges[0].low), vertex_tag(source, edges[0].high),
        tet_tag(source, edges[0].tet), *edge == CORNER ? "a corner" : "on another edge");
  *edge = middles->edge_count++;
  memcpy(middles->rest + 3 * (size_t)*edge, source->positions + 3 * (size_t)node, sizeof(double[3]));
  return STATUS_OK;
}

static Status take_edges(FemMeshMiddles *middles, const FemMeshSource *source, const FemMeshEdge *edges) {
  int count = 6 * source->tet_count;
  for (int v = 0; v < source->vertex_count; v++) middles->edge_of_vertex[v] = NOTHING;
  for (int t = 0; t < source->tet_count; t++)
    for (int k = 0; k < 4; k++) middles->edge_of_vertex[source->tets[t][k]] = CORNER;
  for (int begin = 0, end; begin < count; begin = end) {
    end = fem_mesh_edges_end(edges, count, begin);
    TRY(take_edge(middles, source, edges + begin, end - begin));
  }
  for (int v = 0; v < source->vertex_count; v++)
    if (middles->edge_of_vertex[v] == CORNER) middles->edge_of_vertex[v] = NOTHING;
  return STATUS_OK;
}

Status fem_mesh_middles_number(FemMeshMiddles *middles, const FemMeshSource *source) {
  FemMeshEdge *edges;
  *middles = (FemMeshMiddles){0};
  TRY(fem_mesh_edges_list(&edges, source->tet_count, (const int(*)[4])source->tets));
  // Room for as many edges as there could be, six a tetrahedron.
  middles->rest = memory_zeroed(6 * (size_t)source->tet_count, sizeof(double[3]));
  middles->edge_of_vertex = memory_zeroed((size_t)source->vertex_count, sizeof *middles->edge_of_vertex);
  Status status = middles->rest && middles->edge_of_vertex ? take_edges(middles, source, edges)
                                                           : status_no_memory("a second-order mesh");
  memory_free(edges);
  if (status) fem_mesh_middles_destroy(middles);
  return status;
}

void fem_mesh_middles_destroy(FemMeshMiddles *middles) {
  memory_free(middles->rest), memory_free(middles->edge_of_vertex);
  *middles = (FemMeshMiddles){0};
}

static Vec3 vertex(const FemMesh *mesh, int v) {
  return vec3_at(mesh->rest + 3 * (size_t)v);
}

// How far the node lies from the middle of its edge, over the edge's length.
static double deviation_of(const FemMesh *mesh, const FemMeshEdge *edge, const double middle[3]) {
  Vec3 low = vertex(mesh, edge->low), along = vec3_sub(vertex(mesh, edge->high), low);
  Vec3 from_low = vec3_sub(vec3_at(middle), low);
  return vec3_length(vec3_sub(from_low, vec3_scale(0.5, along))) / vec3_length(along);
}

// The shape of tetrahedron t, whose nodes on edges are those of `edge_of`.
static void measure_tet(const FemMesh *mesh, int t, const int edge_of[6], FemMeshCurvature *curvature) {
  double nodes[30];
  FemQuadratic element;
  for (int k = 0; k < 4; k++) vec3_store(nodes + 3 * k, vertex(mesh, mesh->tets[t][k]));
  for (int k = 0; k < 6; k++) vec3_store(nodes + 12 + 3 * k, vec3_at(mesh->middles + 3 * (size_t)edge_of[k]));
  fem_quadratic_create_curved(&element, nodes);
  curvature->volume += element.volume;
  double jacobian = fem_quadratic_min_jacobian(nodes);
  if (!(jacobian < curvature->min_jacobian)) return;
  curvature->min_jacobian = jacobian, curvature->min_jacobian_tet = t;
}

Status fem_mesh_curvature(const FemMesh *mesh, FemMeshCurvature *curvature) {
  *curvature = (FemMeshCurvature){.min_jacobian = INFINITY};
  if (!mesh->middles) return STATUS_OK;
  FemMeshEdge *edges;
  TRY(fem_mesh_edges_list(&edges, mesh->tet_count, (const int(*)[4])mesh->tets));
  int(*edge_of)[6] = memory_zeroed((size_t)mesh->tet_count, sizeof *edge_of);
  int count = 6 * mesh->tet_count, number = 0;
  for (int begin = 0, end; edge_of && begin < count; begin = end, number++) {
    end = fem_mesh_edges_end(edges, count, begin);
    double deviation = deviation_of(mesh, &edges[begin], mesh->middles + 3 * (size_t)number);
    curvature->deviation = fmax(curvature->deviation, deviation);
    for (int k = begin; k < end; k++) edge_of[edges[k].tet][edges[k].local] = number;
  }
  for (int t = 0; edge_of && t < mesh->tet_count; t++) measure_tet(mesh, t, edge_of[t], curvature);
  memory_free(edges);
  if (!edge_of) return status_no_memory("the edges of a mesh");
  memory_free(edge_of);
  return STATUS_OK;
}

void fem_mesh_make_linear(FemMesh *mesh) {
  memory_free(mesh->middles), memory_free(mesh->tet_tags);
  mesh->middles = NULL, mesh->tet_tags = NULL, mesh->edge_count = 0;
  for (int g = 0; g < mesh->group_count; g++) {
    memory_free(mesh->groups[g].middles);
    mesh->groups[g].middles = NULL, mesh->groups[g].middle_count = 0;
  }
}
