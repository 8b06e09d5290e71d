// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/all.h"

#include <stdbool.h>
#include <string.h>

#include "app/stress/pairs/pairs.h"
#include "app/stress/scenes.h"
#include "base/memory.h"
#include "base/text.h"
#include "overlap/models.h"
#include "overlap/source.h"

static const char ANY[] = "any";

static Status fail_model(const char *word) {
  char known[256];
  size_t used = 0;
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  TextGuess guess = text_guess_of(word);
  text_guess_offer(&guess, ANY);
  text_append(known, sizeof known, &used, "%s", ANY);
  for (int m = 0; m < count; m++) {
    text_append(known, sizeof known, &used, ", %s", models[m]->name);
    text_guess_offer(&guess, models[m]->name);
  }
  return status_fail(STATUS_USAGE, "--overlap: there is no model '%s'%s%s%s; known are %s", word,
                     guess.best ? ": did you mean '" : "", guess.best ? guess.best : "",
                     guess.best ? "'?" : "", known);
}

static bool is_known(const char *word) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++)
    if (strcmp(models[m]->name, word) == 0) return true;
  return strcmp(ANY, word) == 0;
}

static Status check_model(const AppStressOptions *options, const char *word) {
  char path[PATH_MAX];
  if (!app_model_names_locate(word, path) && !overlap_source_is_foreign(word))
    return is_known(word) ? STATUS_OK : fail_model(word);
  if (!options->has_scenes) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "--overlap %s: of models in files, and of other programs, only the pairs are measured; "
                     "add --pairs, and see `tetlap "
                     "compare` for scenes",
                     word);
}

static Status check_models(const AppStressOptions *options) {
  if (!options->models) return STATUS_OK;
  const char *words[APP_STRESS_MAX_MODELS];
  char *list = memory_copy(options->models, strlen(options->models) + 1, 1);
  if (!list) return status_no_memory("the models");
  int count = text_split(list, words, APP_STRESS_MAX_MODELS);
  Status status =
      count < 0 ? status_fail(STATUS_USAGE, "--overlap names more than %d models", APP_STRESS_MAX_MODELS)
                : STATUS_OK;
  for (int w = 0; w < count && !status; w++) status = check_model(options, words[w]);
  memory_free(list);
  return status;
}

Status app_stress_all_run(const AppStressOptions *options, AppStress *stress) {
  *stress = (AppStress){0};
  TRY(check_models(options));
  if (options->has_pairs) TRY(app_stress_pairs_run(options, stress));
  if (options->has_scenes) TRY(app_stress_scenes_run(options, stress));
  if (stress->count > 0) return STATUS_OK;
  if (options->only && options->models)
    return status_fail(STATUS_USAGE, "no case with '%s' in its name has a model of '%s'", options->only,
                       options->models);
  if (options->only) return status_fail(STATUS_USAGE, "no case has '%s' in its name", options->only);
  return status_fail(STATUS_USAGE, "no case has a model of '%s'", options->models ? options->models : "");
}
