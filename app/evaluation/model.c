// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/model.h"

#include <string.h>

#include "overlap/geo/model.h"
#include "overlap/source.h"
#include "overlap/tpn/model.h"

Status app_evaluation_model_open_with(OverlapModel *model, const char *name, const OverlapOptions *options) {
  *model = (OverlapModel){0};
  if (strcmp(name, "geo-constant") != 0) return overlap_model_create_with(model, name, NULL, options);
  TRY(overlap_geo_model_create(&model->self, NULL));
  model->ops = &overlap_geo_ops;
  return STATUS_OK;
}

Status app_evaluation_model_open(OverlapModel *model, const char *name) {
  return app_evaluation_model_open_with(model, name, NULL);
}

AppEvaluationLogits app_evaluation_model_logits(const OverlapModel *model) {
  if (overlap_source_is_foreign(model->ops->name)) return model->ops->eval_logits;
  return model->ops->eval_batch == overlap_tpn_model_eval_batch ? overlap_tpn_model_logits : NULL;
}
