// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/all.h"

#include <stdbool.h>
#include <string.h>

#include "app/stress/pairs/pairs.h"
#include "app/stress/scenes.h"
#include "base/text.h"
#include "overlap/model.h"
#include "overlap/weights.h"

static const char ANY[] = "any";

static Status fail_model(const char *word) {
  char known[256];
  size_t used = 0;
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  if (overlap_weights_is_path(word))
    return status_fail(
        STATUS_USAGE,
        "--overlap %s: hard cases are asked of the program's own models; `tetlap eval` and `tetlap "
        "compare` take weights files",
        word);
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
  const OverlapOps *const *models = overlap_model_list(&count);
  for (int m = 0; m < count; m++)
    if (strcmp(models[m]->name, word) == 0) return true;
  return strcmp(ANY, word) == 0;
}

static Status check_models(const AppStressOptions *options) {
  char word[TEXT_MAX_WORD];
  for (const char *rest = text_next(options->models, word); rest; rest = text_next(rest, word))
    if (!is_known(word)) return fail_model(word);
  return STATUS_OK;
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
