// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/models.h"

#include "app/bench/options.h"
#include "overlap/model.h"

int app_bench_models_list(const char *names[APP_BENCH_MAX_MODELS]) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  if (count > APP_BENCH_MAX_MODELS) count = APP_BENCH_MAX_MODELS;
  for (int m = 0; m < count; m++) names[m] = models[m]->name;
  return count;
}

void app_bench_models_choose(struct argp_state *state, const char *option, char *text,
                             bool wanted[APP_BENCH_MAX_MODELS]) {
  const char *names[APP_BENCH_MAX_MODELS];
  int count = app_bench_models_list(names);
  app_bench_options_choose(state, option, text, names, count, wanted);
}
