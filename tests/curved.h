// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes of curved second-order tetrahedra: nodes on edges are moved at random, those on a side of the box
// within it.
#ifndef TETLAP_TESTS_CURVED_H
#define TETLAP_TESTS_CURVED_H

#include <stdbool.h>
#include <stdio.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/mesh/edges.h"
#include "fem/mesh/mesh.h"
#include "suite.h"

// A point (the middle of an edge), moved by up to `jitter` of a cell in each coordinate that is not that of a side.
static inline void curved_move(const double size[3], const int cells[3], double jitter, Random *random,
                               double middle[3]) {
  for (int c = 0; c < 3; c++) {
    double by = jitter * size[c] / cells[c] * random_between(random, -1, 1);
    bool is_on_side = middle[c] < 1e-12 * size[c] || middle[c] > (1 - 1e-12) * size[c];
    if (!is_on_side) middle[c] += by;
  }
}

// A box from 0 to `size`, second-order but not yet quadratic: fem_mesh_make_quadratic is the caller's.
static inline void curved_box(FemMesh *mesh, const double size[3], const int cells[3], double jitter,
                              uint64_t stream) {
  FemMeshEdge *edges;
  Random random = random_seeded(3, stream);
  ck_assert_ok(fem_mesh_box(mesh, size, cells));
  ck_assert_ok(fem_mesh_edges_list(&edges, mesh->tet_count, (const int(*)[4])mesh->tets));
  int count = 6 * mesh->tet_count;
  mesh->middles = memory_zeroed((size_t)count, 3 * sizeof(double));
  ck_assert_ptr_nonnull(mesh->middles);
  for (int begin = 0; begin < count; begin = fem_mesh_edges_end(edges, count, begin)) {
    double *middle = mesh->middles + 3 * mesh->edge_count++;
    for (int c = 0; c < 3; c++)
      middle[c] = 0.5 * (mesh->rest[3 * edges[begin].low + c] + mesh->rest[3 * edges[begin].high + c]);
    curved_move(size, cells, jitter, &random, middle);
  }
  memory_free(edges);
}

// As a legacy VTK file.
static inline void curved_write(const FemMesh *mesh, const char *path) {
  FemMeshEdge *edges;
  int count = 6 * mesh->tet_count, number = 0;
  ck_assert_ok(fem_mesh_edges_list(&edges, mesh->tet_count, (const int(*)[4])mesh->tets));
  int(*nodes)[10] = calloc((size_t)mesh->tet_count, sizeof *nodes);
  FILE *stream = fopen(path, "w");
  ck_assert(nodes && stream);
  fprintf(stream, "# vtk DataFile Version 2.0\ncurved\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n",
          mesh->vertex_count + mesh->edge_count);
  for (int v = 0; v < mesh->vertex_count; v++)
    fprintf(stream, "%.17g %.17g %.17g\n", mesh->rest[3 * v], mesh->rest[3 * v + 1], mesh->rest[3 * v + 2]);
  for (int m = 0; m < mesh->edge_count; m++)
    fprintf(stream, "%.17g %.17g %.17g\n", mesh->middles[3 * m], mesh->middles[3 * m + 1],
            mesh->middles[3 * m + 2]);
  for (int begin = 0, end; begin < count; begin = end, number++) {
    static const int PLACE[6] = {4, 6, 7,
                                 5, 8, 9}; // edges 01 02 03 12 13 23 in VTK's order 01 12 02 03 13 23
    end = fem_mesh_edges_end(edges, count, begin);
    for (int k = begin; k < end; k++)
      nodes[edges[k].tet][PLACE[edges[k].local]] = mesh->vertex_count + number;
  }
  fprintf(stream, "\nCELLS %d %d\n", mesh->tet_count, 11 * mesh->tet_count);
  for (int e = 0; e < mesh->tet_count; e++) {
    for (int v = 0; v < 4; v++) nodes[e][v] = mesh->tets[e][v];
    fputs("10", stream);
    for (int k = 0; k < 10; k++) fprintf(stream, " %d", nodes[e][k]);
    fputs("\n", stream);
  }
  fprintf(stream, "\nCELL_TYPES %d\n", mesh->tet_count);
  for (int e = 0; e < mesh->tet_count; e++) fputs("24\n", stream);
  ck_assert_int_eq(fclose(stream), 0);
  free(nodes), memory_free(edges);
}

#endif
