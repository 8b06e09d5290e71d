// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between the models that can be trained: their samples, their loss, how they are measured and
// written. The loop of training.h drives them.
//
// A step's randomness is a function of the seed and of the step's number alone, so a training can be taken up
// at any step.
#ifndef TETLAP_APP_TRAINING_TASK_H
#define TETLAP_APP_TRAINING_TASK_H

#include "app/training/config.h"
#include "net/net.h"

enum { APP_TRAINING_MAX_SCORES = 24, APP_TRAINING_SCORE_NAME = 40 };

// What a validation found; names are columns of the log.
typedef struct AppTrainingScores {
  double score; // the smaller, the better
  int count;
  char names[APP_TRAINING_MAX_SCORES][APP_TRAINING_SCORE_NAME];
  double values[APP_TRAINING_MAX_SCORES];
} AppTrainingScores;

void app_training_scores_add(AppTrainingScores *scores, const char *set, const char *name, double value);

typedef struct AppTrainingTask AppTrainingTask;

typedef struct AppTrainingTaskOps {
  NetShape (*shape)(const AppTrainingConfig *config);
  // Loads data. `whitening` is that of a checkpoint, count 0 without one.
  Status (*create)(AppTrainingTask *task, const NetWhitening *whitening);
  // First weights from `config->start`, for the task's inputs.
  Status (*start)(AppTrainingTask *task, NetModel_f32 *model);
  int rows;                                         // of a batch, beyond its samples
  int (*tangents)(const AppTrainingConfig *config); // of each sample; NULL: none
  // The loss of a batch and its gradient by the parameters.
  double (*step)(AppTrainingTask *task, const NetModel_f32 *model, NetWork_f32 *work, long long step,
                 float *gradient);
  // Measures parameters on the validation data; may use the file `path` to write them to.
  Status (*validate)(AppTrainingTask *task, const NetModel_f32 *model, const char *path,
                     AppTrainingScores *scores);
  // Writes weights that the overlap models read.
  Status (*write)(const AppTrainingTask *task, const NetModel_f32 *model, const char *provenance,
                  const char *path);
  const NetWhitening *(*whitening)(const AppTrainingTask *task); // of the inputs; NULL: there is none
  void (*destroy)(AppTrainingTask *task);
} AppTrainingTaskOps;

struct AppTrainingTask {
  const AppTrainingTaskOps *ops;
  const AppTrainingConfig *config; // borrowed
  void *self;                      // owned by the operations
  char summary[512];               // of the data, for people and for the weights' file
};

extern const AppTrainingTaskOps app_training_geo, app_training_tpn, app_training_bound;

const AppTrainingTaskOps *app_training_task_find(AppModelKind kind);

// A NetStatus that failed as ours, with the message.
Status app_training_task_fail(NetStatus status);

// The order of all samples in an epoch, kept between steps.
typedef struct AppTrainingOrder {
  int *order; // (count), owned
  int count;
  long long epoch; // that `order` is of; −1: of none
} AppTrainingOrder;

Status app_training_order_create(AppTrainingOrder *order, int count);
void app_training_order_destroy(AppTrainingOrder *order);
// The samples of a step: `batch` consecutive places of the epochs laid end to end.
void app_training_order_take(AppTrainingOrder *order, int seed, long long step, int batch, int *samples);

#endif
