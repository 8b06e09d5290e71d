// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation_model.h"

#include <stdbool.h>
#include <string.h>

#include "base/file.h"
#include "contact/geo_overlap.h"
#include "contact/net_overlap.h"
#include "net/weights.h"

// `self` is made from a path, so there is no `create`.
static const ContactOverlapOps geo_of_file = {
    .name = "geo",
    .help = "the analytic-centre frame with the network of a file",
    .has_hessian = true,
    .seconds_per_pair = 5e-6,
    .eval_pair = contact_geo_overlap_eval_pair,
    .eval_batch = contact_geo_overlap_eval_batch,
    .destroy = contact_geo_overlap_destroy,
};

static const ContactOverlapOps tpn_of_file = {
    .name = "tpn",
    .help = "TetrahedronPairNet with the weights of a file",
    .seconds_per_pair = 1e-5,
    .eval_pair = contact_net_overlap_eval_pair,
    .eval_batch = contact_net_overlap_eval_batch,
    .destroy = contact_net_overlap_destroy,
};

static bool is_path(const char *name) {
  size_t length = strlen(name);
  static const char ending[] = ".safetensors";
  size_t wanted = sizeof ending - 1;
  return strchr(name, '/') || (length > wanted && strcmp(name + length - wanted, ending) == 0);
}

// A file says by its network's shape which model it is.
static Status open_file(ContactOverlapModel *model, const char *path) {
  NetModel_f32 network = {0};
  NetCard card = {0};
  if (!file_exists(path)) return status_fail(STATUS_IO, "%s: there is no such file", path);
  if (net_weights_read_f32(path, &network, &card) != NET_OK)
    return status_fail(STATUS_INPUT, "%s", net_status_message());
  bool is_tpn = network.plan->shape.kind == NET_TPN;
  net_card_destroy(&card);
  net_model_destroy_f32(&network);
  TRY(is_tpn ? contact_net_overlap_create(&model->self, path)
             : contact_geo_overlap_create(&model->self, path));
  model->ops = is_tpn ? &tpn_of_file : &geo_of_file;
  return STATUS_OK;
}

Status app_evaluation_model_open(ContactOverlapModel *model, const char *name) {
  *model = (ContactOverlapModel){0};
  if (is_path(name)) return open_file(model, name);
  if (strcmp(name, "geo-constant") != 0) return contact_overlap_create(model, name);
  TRY(contact_geo_overlap_create(&model->self, NULL));
  model->ops = &geo_of_file;
  return STATUS_OK;
}

AppEvaluationLogits app_evaluation_model_logits(const ContactOverlapModel *model) {
  return model->ops->eval_batch == contact_net_overlap_eval_batch ? contact_net_overlap_logits : NULL;
}
