// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/multigrid/cycle.h"

#include <omp.h>
#include <stdbool.h>

#include "base/memory.h"
#include "fem/sparse/front/dense.h"

// Rows of a node of the finest level: a vertex.
enum { FINE_WIDTH = 3 };
// A coarsest level with more rows is swept, as is one that rounding has left without a factor.
enum { MOST_SOLVED = 300 };
// A level with fewer entries is over before another thread has seen it.
enum { FEW_ENTRIES = 50000 };

static Status factorise_coarsest(FemCycle *cycle, const FemRows *matrix) {
  size_t n = (size_t)matrix->count;
  if (n > MOST_SOLVED) return STATUS_OK;
  cycle->factor = memory_zeroed(n * n, sizeof *cycle->factor);
  if (!cycle->factor) return status_no_memory("the multigrid of the condensed system");
  for (int i = 0; i < matrix->count; i++)
    for (int k = matrix->begin[i]; k < matrix->begin[i + 1]; k++)
      cycle->factor[n * (size_t)matrix->column[k] + (size_t)i] += matrix->value[k];
  if (fem_dense_factorise(matrix->count, (FemDense){cycle->factor, matrix->count})) return STATUS_OK;
  memory_free(cycle->factor);
  cycle->factor = NULL;
  return STATUS_OK;
}

static Status create(FemCycle *cycle, int level_count, const FemRows *matrices,
                     const FemRows *interpolations) {
  cycle->levels = memory_zeroed((size_t)level_count, sizeof *cycle->levels);
  if (!cycle->levels) return status_no_memory("the multigrid of the condensed system");
  cycle->level_count = level_count;
  for (int l = 0; l < level_count; l++)
    TRY(fem_level_create(&cycle->levels[l], &matrices[l], l == 0 ? FINE_WIDTH : 1));
  for (int l = 0; l + 1 < level_count; l++)
    TRY(fem_level_connect(&cycle->levels[l], &cycle->levels[l + 1], &interpolations[l]));
  return factorise_coarsest(cycle, &matrices[level_count - 1]);
}

Status fem_cycle_create(FemCycle *cycle, int level_count, const FemRows *matrices,
                        const FemRows *interpolations) {
  *cycle = (FemCycle){0};
  Status status = create(cycle, level_count, matrices, interpolations);
  if (status) fem_cycle_destroy(cycle);
  return status;
}

void fem_cycle_destroy(FemCycle *cycle) {
  for (int l = 0; l < cycle->level_count; l++) fem_level_destroy(&cycle->levels[l]);
  memory_free(cycle->levels);
  memory_free(cycle->factor);
  *cycle = (FemCycle){0};
}

// Forward and back through the columns of L, in the order of the given rows.
static void solve_coarsest(const FemCycle *cycle, FemLevel *level) {
  const int n = level->width * level->count;
  double *y = level->r;
  for (int i = 0; i < n; i++) y[i] = level->b[fem_level_place(level, i)];
  for (int j = 0; j < n; j++) {
    const double *column = cycle->factor + (size_t)n * (size_t)j;
    y[j] /= column[j];
    for (int i = j + 1; i < n; i++) y[i] -= column[i] * y[j];
  }
  for (int j = n - 1; j >= 0; j--) {
    const double *column = cycle->factor + (size_t)n * (size_t)j;
    for (int i = j + 1; i < n; i++) y[j] -= column[i] * y[i];
    y[j] /= column[j];
  }
  for (int i = 0; i < n; i++) level->x[fem_level_place(level, i)] = y[i];
}

static void descend(FemCycle *cycle, int l, FemTeam team);

// The level below: by the whole team where it is large, else by its first thread while the others wait.
static void go_below(FemCycle *cycle, int l, FemTeam team) {
  const FemLevel *level = &cycle->levels[l];
  if (team.size == 1 || level->begin[level->count] >= FEW_ENTRIES) {
    descend(cycle, l, team);
    return;
  }
  if (team.rank == 0) descend(cycle, l, (FemTeam){0, 1});
#pragma omp barrier
}

static void descend(FemCycle *cycle, int l, FemTeam team) {
  FemLevel *level = &cycle->levels[l];
  bool is_coarsest = l + 1 == cycle->level_count;
  if (is_coarsest && cycle->factor) {
    if (team.rank == 0) solve_coarsest(cycle, level);
    if (team.size > 1) {
#pragma omp barrier
    }
    return;
  }
  fem_level_sweep_down(level, team);
  if (!is_coarsest) {
    fem_level_restrict(level, &cycle->levels[l + 1], team);
    go_below(cycle, l + 1, team);
    fem_level_prolong(level, &cycle->levels[l + 1], team);
  }
  fem_level_sweep_up(level, team);
}

void fem_cycle_apply(FemCycle *cycle, const double *b, double *x) {
  FemLevel *finest = &cycle->levels[0];
  const int count = finest->width * finest->count;
  const bool is_large = finest->begin[finest->count] >= FEW_ENTRIES / (FINE_WIDTH * FINE_WIDTH);
#pragma omp parallel if (is_large)
  {
    FemTeam team = {omp_get_thread_num(), omp_get_num_threads()};
#pragma omp for schedule(static)
    for (int i = 0; i < count; i++) finest->b[fem_level_place(finest, i)] = b[i];
    descend(cycle, 0, team);
#pragma omp for schedule(static)
    for (int i = 0; i < count; i++) x[i] = finest->x[fem_level_place(finest, i)];
  }
}
