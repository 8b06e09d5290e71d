// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/result/spread.h"

#include <assert.h>
#include <string.h>

#include "base/ranks.h"
#include "fem/model/division.h"

static int own_vertices(const FemModel *model) {
  int count = 0;
  for (int v = 0; v < model->vertex_count; v++) count += fem_share_has(model->share, 1, &v);
  return count;
}

// In the order of spread_names of fem/run/result/run_result.c.
static void measure(const FemRunState *run, double values[FEM_RUN_SPREAD_COUNT]) {
  const FemRunResult *result = run->result;
  const FemRunPhases *phases = &result->cost.phases;
  const RanksStats *stats = ranks()->stats();
  const double all[] = {own_vertices(run->model),
                        fem_model_division_elements(run->model),
                        run->system.matrix.entry_count,
                        (double)result->cost.peak_rss_bytes,
                        result->cost.cpu_s,
                        result->cost.work_s,
                        stats->waiting_s,
                        (double)(stats->sums + stats->pieces + stats->decisions),
                        (double)stats->bytes,
                        phases->broad_phase,
                        phases->overlap,
                        phases->contact,
                        phases->forces,
                        phases->assembly,
                        phases->analysis,
                        phases->factorisation,
                        phases->solve,
                        phases->output};
  static_assert(sizeof all == FEM_RUN_SPREAD_COUNT * sizeof *all, "a name for each");
  memcpy(values, all, sizeof all);
}

void fem_run_spread_collect(const FemRunState *run, FemRunResult *result) {
  FemRunSpread *spread = &result->spread;
  if (!run->model->share) return;
  spread->rank_count = ranks()->count;
  measure(run, spread->mean);
  for (int k = 0; k < FEM_RUN_SPREAD_COUNT; k++) {
    spread->most[k] = spread->mean[k];
    spread->least[k] = -spread->mean[k];
  }
  ranks()->sum(spread->mean, FEM_RUN_SPREAD_COUNT);
  ranks()->most(spread->most, FEM_RUN_SPREAD_COUNT);
  ranks()->most(spread->least, FEM_RUN_SPREAD_COUNT);
  for (int k = 0; k < FEM_RUN_SPREAD_COUNT; k++) {
    spread->mean[k] /= spread->rank_count;
    spread->least[k] = -spread->least[k];
  }
}
