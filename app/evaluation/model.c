// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/model.h"

#include <string.h>

#include "overlap/geo/model.h"
#include "overlap/tpn/model.h"

Status app_evaluation_model_open_with(OverlapModel *model, const char *name, const OverlapOptions *options) {
  static const char HYBRID[] = "hybrid=";
  *model = (OverlapModel){0};
  if (strncmp(name, HYBRID, strlen(HYBRID)) == 0)
    return overlap_model_create_with(model, "hybrid", name + strlen(HYBRID), options);
  if (strcmp(name, "geo-constant") != 0) return overlap_model_create_with(model, name, NULL, options);
  TRY(overlap_geo_model_create(&model->self, NULL));
  model->ops = &overlap_geo_ops;
  return STATUS_OK;
}

Status app_evaluation_model_open(OverlapModel *model, const char *name) {
  return app_evaluation_model_open_with(model, name, NULL);
}

AppEvaluationLogits app_evaluation_model_logits(const OverlapModel *model) {
  return model->ops->eval_batch == overlap_tpn_model_eval_batch ? overlap_tpn_model_logits : NULL;
}
