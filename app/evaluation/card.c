// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/card.h"

#include <limits.h>
#include <stdio.h>

#include "net/files/weights.h"
#include "overlap/source.h"
#include "overlap/weights.h"

Status app_evaluation_card_read(const OverlapModel *model, const char *name, AppModelCard *card) {
  char path[PATH_MAX];
  *card = (AppModelCard){.family = model->ops->name};
  if (overlap_source_is_foreign(name)) return STATUS_OK;
  name = overlap_source_model(name);
  bool is_path = overlap_weights_is_path(name);
  if (!is_path && model->ops->weights) name = model->ops->weights;
  if (is_path)
    snprintf(path, sizeof path, "%s", name);
  else if (overlap_weights_find(name, path, sizeof path) != STATUS_OK)
    return STATUS_OK; // no weights under that name: not learned
  NetModel_f32 network = {0};
  NetCard text = {0};
  NetStatus status = net_weights_read_f32(path, &network, &text);
  if (status == NET_OK) {
    card->family = network.plan->shape.kind == NET_TPN ? "tpn" : "geo";
    card->parameters = (long long)network.plan->parameter_count;
  }
  net_weights_card_destroy(&text);
  net_model_destroy_f32(&network);
  return status == NET_OK ? STATUS_OK : status_fail(STATUS_INPUT, "%s", net_status_message());
}
