// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation_model.h"

#include <string.h>

#include "contact/geo_overlap.h"
#include "contact/net_overlap.h"

Status app_evaluation_model_open(ContactOverlapModel *model, const char *name) {
  *model = (ContactOverlapModel){0};
  if (strcmp(name, "geo-constant") != 0) return contact_overlap_create(model, name);
  TRY(contact_geo_overlap_create(&model->self, NULL));
  model->ops = &contact_overlap_geo;
  return STATUS_OK;
}

AppEvaluationLogits app_evaluation_model_logits(const ContactOverlapModel *model) {
  return model->ops->eval_batch == contact_net_overlap_eval_batch ? contact_net_overlap_logits : NULL;
}
