// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of tetrahedra for tests of contact: boxes of nx × ny × nz cells, six Kuhn tetrahedra each, one body
// a block.
#ifndef TETLAP_TESTS_BLOCKS_H
#define TETLAP_TESTS_BLOCKS_H

#include <string.h>

#include "suite.h"

#include "base/random.h"
#include "contact/system.h"

enum { BLOCKS_MAX = 4 };

typedef struct Blocks {
  int vertex_count, tet_count, body_count;
  double *x;      // (vertex_count, 3)
  int (*tets)[4]; // (tet_count)
  ContactBody bodies[BLOCKS_MAX];
} Blocks;

typedef struct BlockDef {
  double corner[3], cell[3];
  int cells[3];
  double jitter; // of every vertex, as a share of a cell
  bool is_obstacle;
} BlockDef;

static inline void blocks_add_tets(Blocks *blocks, const int cells[3], int first_vertex) {
  static const int ORDERS[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  int stride[3] = {1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)};
  for (int k = 0; k < cells[2]; k++)
    for (int j = 0; j < cells[1]; j++)
      for (int i = 0; i < cells[0]; i++)
        for (int o = 0; o < 6; o++) {
          int *tet = blocks->tets[blocks->tet_count++];
          tet[0] = first_vertex + i + j * stride[1] + k * stride[2];
          for (int v = 0; v < 3; v++) tet[v + 1] = tet[v] + stride[ORDERS[o][v]];
        }
}

static inline void blocks_add(Blocks *blocks, const BlockDef *def) {
  const int *cells = def->cells;
  int vertices = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1), tets = 6 * cells[0] * cells[1] * cells[2];
  int first_vertex = blocks->vertex_count, first_tet = blocks->tet_count;
  ck_assert_int_lt(blocks->body_count, BLOCKS_MAX);
  blocks->x = realloc(blocks->x, 3 * sizeof(double) * (size_t)(first_vertex + vertices));
  blocks->tets = realloc(blocks->tets, sizeof *blocks->tets * (size_t)(first_tet + tets));
  ck_assert(blocks->x && blocks->tets);
  Random random = random_seeded(7, (uint64_t)blocks->body_count);
  for (int k = 0; k <= cells[2]; k++)
    for (int j = 0; j <= cells[1]; j++)
      for (int i = 0; i <= cells[0]; i++) {
        double *x = blocks->x + 3 * blocks->vertex_count++;
        for (int c = 0; c < 3; c++)
          x[c] = def->corner[c] +
                 def->cell[c] * ((int[]){i, j, k}[c] + def->jitter * random_between(&random, -1, 1));
      }
  blocks_add_tets(blocks, cells, first_vertex);
  blocks->bodies[blocks->body_count++] = (ContactBody){.name = "block",
                                                       .vertex_begin = first_vertex,
                                                       .vertex_end = blocks->vertex_count,
                                                       .tet_begin = first_tet,
                                                       .tet_end = blocks->tet_count,
                                                       .is_obstacle = def->is_obstacle};
}

// A definition over these blocks, nodal, κ = 1000 Pa, at their present positions as rest.
static inline ContactSystemDef blocks_def(const Blocks *blocks, const double *rest,
                                          const OverlapModel *model) {
  return (ContactSystemDef){.vertex_count = blocks->vertex_count,
                            .rest = rest,
                            .tets = (const int(*)[4])blocks->tets,
                            .tet_count = blocks->tet_count,
                            .bodies = blocks->bodies,
                            .body_count = blocks->body_count,
                            .stiffness = 1000,
                            .model = model};
}

static inline double *blocks_copy(const Blocks *blocks) {
  double *copy = malloc(3 * sizeof(double) * (size_t)blocks->vertex_count);
  ck_assert_ptr_nonnull(copy);
  memcpy(copy, blocks->x, 3 * sizeof(double) * (size_t)blocks->vertex_count);
  return copy;
}

static inline void blocks_shift(const Blocks *blocks, double *x, int body, const double by[3]) {
  for (int v = blocks->bodies[body].vertex_begin; v < blocks->bodies[body].vertex_end; v++)
    for (int c = 0; c < 3; c++) x[3 * v + c] += by[c];
}

// The four sides of blocks of that width that stand on each other, bits 0 … 3           (vertex_count)
static inline unsigned char *blocks_mark_sides(const Blocks *blocks, double width) {
  unsigned char *inner = calloc((size_t)blocks->vertex_count, 1);
  ck_assert_ptr_nonnull(inner);
  for (int v = 0; v < blocks->vertex_count; v++)
    for (int c = 0; c < 2; c++) {
      double x = blocks->x[3 * v + c];
      if (fabs(x) < 1e-9) inner[v] |= (unsigned char)(1 << 2 * c);
      if (fabs(x - width) < 1e-9) inner[v] |= (unsigned char)(2 << 2 * c);
    }
  return inner;
}

static inline void blocks_destroy(Blocks *blocks) {
  free(blocks->x);
  free(blocks->tets);
}

#endif
