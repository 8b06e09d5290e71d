// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's matrices of a bar, for the tests of linear solvers.
#pragma once

#include "suite.h"

#include "base/memory.h"
#include "base/random.h"
#include "fem/sparse/solver.h"

// A bar of cells × 3 × 3 cubes cut into six tetrahedra each; a random positive semi-definite matrix a
// tetrahedron for K and D, random masses. One end is fixed, some coordinates elsewhere too.
typedef struct Bar {
  int vertex_count, unknown_count;
  int *unknown_of_dof;
  double *mass, *mass_of_unknown;
  FemPattern *pattern;
  FemMatrix K, D, S; // S = K + c D + c² M
  double c;
} Bar;

static inline void add_tet(Bar *bar, Random *random, const int tet[4]) {
  double dense[144] = {0}, w[12];
  for (int k = 0; k < 8; k++) {
    double mean[3] = {0};
    for (int i = 0; i < 12; i++) w[i] = suite_normal(random), mean[i % 3] += 0.25 * w[i];
    for (int i = 0; i < 12; i++) w[i] -= mean[i % 3]; // no force from a translation
    for (int i = 0; i < 144; i++) dense[i] += w[i / 12] * w[i % 12];
  }
  fem_matrix_add(&bar->K, 4, tet, dense, 1);
  fem_matrix_add(&bar->D, 4, tet, dense, 0.03);
}

// Calls add_tet, or with `is_layout` only tells the pattern, for each of the six tetrahedra of every cube.
static inline void visit_tets(Bar *bar, int cells, bool is_layout) {
  static const int paths[6][2] = {{1, 2}, {1, 4}, {2, 1}, {2, 4}, {4, 1}, {4, 2}}; // axis bits of a Kuhn path
  Random random = random_seeded(42, 0);
  for (int cube = 0; cube < 9 * cells; cube++) {
    int corner[8];
    for (int k = 0; k < 8; k++)
      corner[k] = (cube / 9 + (k & 1)) * 16 + (cube / 3 % 3 + (k >> 1 & 1)) * 4 + cube % 3 + (k >> 2);
    for (int p = 0; p < 6; p++) {
      int tet[4] = {corner[0], corner[paths[p][0]], corner[paths[p][0] | paths[p][1]], corner[7]};
      if (is_layout)
        ck_assert_ok(fem_pattern_add_clique(bar->pattern, 4, tet, NULL));
      else
        add_tet(bar, &random, tet);
    }
  }
}

static inline Bar bar_create(int cells, double c) {
  Bar bar = {.vertex_count = 16 * (cells + 1), .c = c};
  size_t vertices = (size_t)bar.vertex_count;
  Random random = random_seeded(43, 0);
  bar.unknown_of_dof = memory_zeroed(3 * vertices, sizeof *bar.unknown_of_dof);
  bar.mass = memory_zeroed(vertices, sizeof *bar.mass);
  bar.mass_of_unknown = memory_zeroed(3 * vertices, sizeof *bar.mass_of_unknown);
  for (int v = 0; v < bar.vertex_count; v++) bar.mass[v] = random_between(&random, 0.5, 1.5);
  for (int dof = 0; dof < 3 * bar.vertex_count; dof++) {
    bool is_free = dof >= 48 && random_uniform(&random) > 0.05;
    if (is_free) bar.mass_of_unknown[bar.unknown_count] = bar.mass[dof / 3];
    bar.unknown_of_dof[dof] = is_free ? bar.unknown_count++ : -1;
  }
  ck_assert_ok(fem_pattern_create(&bar.pattern, bar.vertex_count));
  visit_tets(&bar, cells, true);
  ck_assert_ok(fem_matrix_create(&bar.K, bar.pattern, bar.unknown_of_dof));
  ck_assert_ok(fem_matrix_copy_layout(&bar.D, &bar.K));
  ck_assert_ok(fem_matrix_copy_layout(&bar.S, &bar.K));
  visit_tets(&bar, cells, false);
  for (int k = 0; k < bar.S.entry_count; k++) bar.S.value[k] = bar.K.value[k] + c * bar.D.value[k];
  fem_matrix_add_mass(&bar.S, bar.mass, c * c);
  return bar;
}

static inline void bar_destroy(Bar *bar) {
  fem_matrix_destroy(&bar->K), fem_matrix_destroy(&bar->D), fem_matrix_destroy(&bar->S);
  fem_pattern_destroy(bar->pattern);
  memory_free(bar->unknown_of_dof), memory_free(bar->mass), memory_free(bar->mass_of_unknown);
}

static inline double *random_vector(int count, uint64_t seed) {
  Random random = random_seeded(seed, 0);
  double *values = memory_zeroed((size_t)count, sizeof *values);
  for (int i = 0; i < count; i++) values[i] = suite_normal(&random);
  return values;
}
