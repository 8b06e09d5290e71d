// SPDX-License-Identifier: GPL-3.0-or-later
// Training a model: steps of AdamW along a cosine, measured now and then on validation data. In the
// directory:
//
//   NAME.safetensors        the best weights so far, as the overlap models read them
//   checkpoint.safetensors  the whole state, at each validation and when told to stop
//   log.csv, learning.png   app/training/log.h
//   config.yaml             the configuration as it was read
//
// A training that is resumed ends with the same bits as one that was never stopped.
#ifndef TETLAP_APP_TRAINING_TRAINING_H
#define TETLAP_APP_TRAINING_TRAINING_H

#include <signal.h>

#include "app/training/config.h"
#include "app/training/task.h"

typedef struct AppTrainingProgress {
  long long step, step_count;
  double samples, samples_per_s, seconds_left;
  double loss;       // mean since the last validation; that before it, until the next step
  double score;      // of the last validation; NaN before
  double best_score; // NaN before
} AppTrainingProgress;

typedef struct AppTrainingOptions {
  const char *directory;             // made if it is not there
  int threads;                       // ≥ 1
  bool resumes;                      // from the directory's checkpoint, if there is one
  bool replaces;                     // files in the directory that this training did not make
  const volatile sig_atomic_t *stop; // may be NULL; not 0: write a checkpoint and return
  void (*observe)(void *observer, const AppTrainingProgress *progress); // after each step; may be NULL
  void (*tell)(void *observer, const char *text);                       // what happens; may be NULL
  void *observer;
} AppTrainingOptions;

typedef struct AppTrainingResult {
  long long step, best_step;
  double best_score, seconds;
  bool has_stopped_early;
} AppTrainingResult;

// Whether a training in that directory has kept a checkpoint.
bool app_training_has_checkpoint(const char *directory);

// STATUS_INTERRUPTED: told to stop. STATUS_USAGE: it would write over files that are not of this training
// (app/training/guard.h). STATUS_INPUT: data, or a checkpoint of another configuration. STATUS_SOLVER: the
// loss is no longer finite.
Status app_training_run(const AppTrainingConfig *config, const AppTrainingOptions *options,
                        AppTrainingResult *result);

#endif
