// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation_model.h"

#include <string.h>

#include "contact/geo_overlap.h"
#include "contact/net_overlap.h"
#include "contact/weights.h"
#include "net/weights.h"

// A file says by its network's shape which model it is.
static Status open_file(ContactOverlapModel *model, const char *path) {
  NetModel_f32 network = {0};
  NetCard card = {0};
  if (net_weights_read_f32(path, &network, &card) != NET_OK)
    return status_fail(STATUS_INPUT, "%s", net_status_message()); // names the path
  bool is_tpn = network.plan->shape.kind == NET_TPN;
  net_card_destroy(&card);
  net_model_destroy_f32(&network);
  TRY(is_tpn ? contact_net_overlap_create(&model->self, path)
             : contact_geo_overlap_create(&model->self, path));
  model->ops = is_tpn ? &contact_overlap_tpn : &contact_overlap_geo;
  return STATUS_OK;
}

Status app_evaluation_model_open(ContactOverlapModel *model, const char *name) {
  *model = (ContactOverlapModel){0};
  if (contact_weights_is_path(name)) return open_file(model, name);
  if (strcmp(name, "geo-constant") != 0) return contact_overlap_create(model, name);
  TRY(contact_geo_overlap_create(&model->self, NULL));
  model->ops = &contact_overlap_geo;
  return STATUS_OK;
}

AppEvaluationLogits app_evaluation_model_logits(const ContactOverlapModel *model) {
  return model->ops->eval_batch == contact_net_overlap_eval_batch ? contact_net_overlap_logits : NULL;
}
