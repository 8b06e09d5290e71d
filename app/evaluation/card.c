// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/card.h"

#include <stdio.h>
#include <string.h>

#include "net/files/weights.h"
#include "overlap/weights.h"

static void describe(const NetPlan *plan, AppModelCard *card) {
  const NetShape *shape = &plan->shape;
  bool is_tpn = shape->kind == NET_TPN;
  const NetWidths *widths = is_tpn ? &shape->combiner : &shape->hidden;
  card->family = is_tpn ? "tpn" : "geo";
  card->is_learned = true;
  card->is_float = is_tpn; // `geo` computes in double whatever the file holds
  card->features = shape->input_count;
  card->depth = widths->count;
  card->width = widths->count > 0 ? widths->width[0] : 0;
  card->parameters = (long long)plan->parameter_count;
  card->flops = plan->flops;
}

Status app_evaluation_card_read(const OverlapModel *model, const char *name, AppModelCard *card) {
  *card = (AppModelCard){.family = model->ops->name};
  bool is_path = overlap_weights_is_path(name);
  if (!is_path && model->ops->weights) name = model->ops->weights;
  if (is_path)
    snprintf(card->path, sizeof card->path, "%s", name);
  else if (overlap_weights_find(name, card->path, sizeof card->path) != STATUS_OK) {
    card->path[0] = 0;
    return STATUS_OK; // no weights under that name: not learned
  }
  NetModel_f32 network = {0};
  NetCard text = {0};
  NetStatus status = net_weights_read_f32(card->path, &network, &text);
  if (status == NET_OK) describe(network.plan, card);
  net_weights_card_destroy(&text);
  net_model_destroy_f32(&network);
  return status == NET_OK ? STATUS_OK : status_fail(STATUS_INPUT, "%s", net_status_message());
}
