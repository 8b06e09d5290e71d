// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/model.h"

#include <string.h>

#include "overlap/geo/model.h"
#include "overlap/models.h"

Status app_evaluation_model_open(OverlapModel *model, const char *name) {
  *model = (OverlapModel){0};
  if (strcmp(name, "geo-constant") != 0) return overlap_models_create(model, name);
  TRY(overlap_geo_model_create(&model->self, NULL));
  model->ops = &overlap_geo_ops;
  return STATUS_OK;
}

AppEvaluationLogits app_evaluation_model_logits(const OverlapModel *model) {
  return model->ops->eval_logits;
}
