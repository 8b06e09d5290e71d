// SPDX-License-Identifier: GPL-3.0-or-later
// The pairs that models of the analytic-centre frame are trained and measured on, in memory.
#ifndef TETLAP_APP_TRAINING_SETS_H
#define TETLAP_APP_TRAINING_SETS_H

#include "app/evaluation/evaluation.h"
#include "app/training/task.h"

enum { APP_TRAINING_MAX_SETS = 6 };

typedef struct AppTrainingSet {
  char name[APP_TRAINING_SCORE_NAME];
  DatagenPairs pairs; // owned
  size_t count;
} AppTrainingSet;

typedef struct AppTrainingSets {
  AppTrainingSet set[APP_TRAINING_MAX_SETS];
  int count;
} AppTrainingSets;

// The validation data. STATUS_INPUT: more than APP_TRAINING_MAX_SETS sets. Destroy it, whatever happens.
Status app_training_sets_load(AppTrainingSets *sets, const AppTrainingConfig *config);
void app_training_sets_destroy(AppTrainingSets *sets); // a zeroed one is accepted

// Adds what an evaluation found to the scores; returns its part of the score.
typedef double (*AppTrainingSetScore)(const AppEvaluation *result, const char *set,
                                      AppTrainingScores *scores);

// Evaluates the model of a weights file on every set, and adds what `score` makes of each to the scores;
// pairs that a more careful model answered count as wrong.
Status app_training_sets_measure(const AppTrainingSets *sets, const char *path, AppTrainingSetScore score,
                                 AppTrainingScores *scores);

// All training pairs, source after source; to be destroyed with datagen_pairs_destroy.
Status app_training_sets_load_pairs(const AppTrainingConfig *config, DatagenPairs *all, size_t *count);

#endif
