// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/geo/fold.h"

#include <string.h>

#include "app/training/task.h"
#include "base/memory.h"

static Status write(const AppTrainingFold *fold, const NetCard *card, const char *path,
                    NetModel_f64 *folded) {
  net_model_widen(fold->model, folded);
  TRY(app_training_task_fail(net_whitening_fold(fold->whitening, folded)));
  fold->finish(fold->self, folded);
  return app_training_task_fail(net_weights_write_f64(path, folded, card));
}

Status app_training_fold_write(const AppTrainingFold *fold, const char *path) {
  char *story = memory_copy(fold->provenance, strlen(fold->provenance) + 1, 1);
  if (!story) return status_no_memory("the weights' provenance");
  NetCard card = {.normalisation = fold->normalisation, .range = fold->range, .provenance = story};
  NetModel_f64 folded = {0};
  Status status = app_training_task_fail(net_model_create_f64(&fold->model->plan->shape, &folded));
  if (!status) status = write(fold, &card, path, &folded);
  net_model_destroy_f64(&folded);
  memory_free(story);
  return status;
}
