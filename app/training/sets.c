// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/sets.h"

#include <stdio.h>
#include <string.h>

#include "app/evaluation/model.h"

Status app_training_sets_load(AppTrainingSets *sets, const AppTrainingConfig *config) {
  if (config->validation_count > APP_TRAINING_MAX_SETS)
    return status_fail(STATUS_INPUT, "%s: %d validation sets; at most %d", config->path,
                       config->validation_count, APP_TRAINING_MAX_SETS);
  for (int s = 0; s < config->validation_count; s++) {
    AppSourceDef def = app_training_config_source(&config->validation[s]);
    AppTrainingSet *set = &sets->set[s];
    snprintf(set->name, sizeof set->name, "set%d", s + 1);
    if (def.name) snprintf(set->name, sizeof set->name, "%s", def.name);
    TRY(app_dataset_source_load(&def, &set->pairs, &set->count));
    sets->count++;
  }
  return STATUS_OK;
}

void app_training_sets_destroy(AppTrainingSets *sets) {
  for (int s = 0; s < sets->count; s++) datagen_pairs_destroy(&sets->set[s].pairs);
  *sets = (AppTrainingSets){0};
}

static Status measure(const OverlapModel *model, const AppTrainingSet *set, AppTrainingSetScore score,
                      AppTrainingScores *scores) {
  AppEvaluationRun run;
  AppEvaluation result;
  app_evaluation_begin(&run, model, NULL);
  Status status = app_evaluation_add(&run, &set->pairs, set->count);
  if (!status) {
    app_evaluation_finish(&run, &result);
    // what the network did not answer is no merit of its
    scores->score += score(&result, set->name, scores) + (double)result.fallbacks / (double)result.count;
  }
  app_evaluation_end(&run);
  return status;
}

Status app_training_sets_measure(const AppTrainingSets *sets, const char *path, AppTrainingSetScore score,
                                 AppTrainingScores *scores) {
  OverlapModel model;
  TRY(app_evaluation_model_open(&model, path));
  Status status = STATUS_OK;
  for (int s = 0; s < sets->count && !status; s++) status = measure(&model, &sets->set[s], score, scores);
  overlap_model_destroy(&model);
  return status;
}

static void copy_pairs(const DatagenPairs *from, size_t count, const DatagenPairs *to, size_t first) {
  memcpy(to->coordinates + first * 24, from->coordinates, count * 24 * sizeof(double));
  memcpy(to->gradient + first * 24, from->gradient, count * 24 * sizeof(double));
  memcpy(to->volume + first, from->volume, count * sizeof(double));
  memcpy(to->centroid + first * 3, from->centroid, count * 3 * sizeof(double));
}

static Status add_source(const AppTrainingSourceDef *source, DatagenPairs *all, size_t *count) {
  AppSourceDef def = app_training_config_source(source);
  DatagenPairs more, joined;
  size_t more_count;
  TRY(app_dataset_source_load(&def, &more, &more_count));
  Status status = datagen_pairs_create(&joined, *count + more_count, true);
  if (!status) {
    copy_pairs(all, *count, &joined, 0);
    copy_pairs(&more, more_count, &joined, *count);
    datagen_pairs_destroy(all);
    *all = joined;
    *count += more_count;
  }
  datagen_pairs_destroy(&more);
  return status;
}

Status app_training_sets_load_pairs(const AppTrainingConfig *config, DatagenPairs *all, size_t *count) {
  *count = 0;
  TRY(datagen_pairs_create(all, 0, true));
  Status status = STATUS_OK;
  for (int s = 0; s < config->training_count && !status; s++)
    status = add_source(&config->training[s], all, count);
  if (status) datagen_pairs_destroy(all);
  return status;
}
