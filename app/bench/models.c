// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/models.h"

#include <string.h>

#include "app/bench/options.h"
#include "app/cli/argument.h"
#include "app/cli/model_names.h"
#include "base/text.h"
#include "overlap/model.h"

int app_bench_models_list(const char *names[APP_BENCH_MAX_MODELS]) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  if (count > APP_BENCH_MAX_MODELS) count = APP_BENCH_MAX_MODELS;
  for (int m = 0; m < count; m++) names[m] = models[m]->name;
  return count;
}

static bool is_source(const char *word, const char *const *names, int count) {
  static const char HYBRID[] = "hybrid=";
  char path[PATH_MAX];
  if (app_model_names_locate(word, path)) return true;
  if (strncmp(word, HYBRID, strlen(HYBRID)) == 0) word += strlen(HYBRID);
  for (int m = 0; m < count; m++)
    if (strcmp(names[m], word) == 0) return true;
  return false;
}

int app_bench_models_read(struct argp_state *state, const char *option, char *text,
                          const char *sources[APP_BENCH_MAX_MODELS]) {
  const char *names[APP_BENCH_MAX_MODELS];
  char known[256] = "";
  size_t used = 0;
  int count = app_bench_models_list(names);
  for (int m = 0; m < count; m++) text_append(known, sizeof known, &used, "%s%s", m ? ", " : "", names[m]);
  int source_count = app_argument_list(state, option, text, names[0], APP_BENCH_MAX_MODELS, sources);
  for (int s = 0; s < source_count; s++)
    if (!is_source(sources[s], names, count))
      argp_error(state, "--%s has '%s'; give some of: %s; or weights files (….safetensors)", option,
                 sources[s], known);
  return source_count;
}

void app_bench_models_choose(struct argp_state *state, const char *option, char *text,
                             bool wanted[APP_BENCH_MAX_MODELS]) {
  const char *names[APP_BENCH_MAX_MODELS];
  int count = app_bench_models_list(names);
  app_bench_options_choose(state, option, text, names, count, wanted);
}
