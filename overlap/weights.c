// SPDX-License-Identifier: Apache-2.0
#include "overlap/weights.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "net/weights.h"

static const char ENDING[] = ".safetensors";

bool overlap_weights_is_path(const char *name) {
  size_t length = strlen(name), ending = sizeof ENDING - 1;
  return length > ending && strcmp(name + length - ending, ENDING) == 0;
}

Status overlap_weights_find(const char *name, char *path, size_t size) {
  const char *directory = getenv("TETLAP_WEIGHTS");
  if (!directory) directory = TETLAP_WEIGHTS_DIR;
  int length = snprintf(path, size, "%s/%s%s", directory, name, ENDING);
  if (length < 0 || (size_t)length >= size)
    return status_fail(STATUS_INPUT, "%s: the path is too long", directory);
  if (file_exists(path)) return STATUS_OK;
  return status_fail(STATUS_IO,
                     "the weights of '%s' are not at %s; set TETLAP_WEIGHTS to the folder that holds them, "
                     "or name a weights file",
                     name, path);
}

Status overlap_weights_kind(const char *path, OverlapWeightsKind *kind) {
  NetModel_f32 network;
  NetCard card;
  NetStatus status = net_weights_read_f32(path, &network, &card);
  if (status != NET_OK) // names the path
    return status_fail(status == NET_BAD_IO ? STATUS_IO : STATUS_INPUT, "%s", net_status_message());
  *kind = network.plan->shape.kind == NET_TPN ? OVERLAP_WEIGHTS_TPN : OVERLAP_WEIGHTS_GEO;
  net_weights_card_destroy(&card);
  net_model_destroy_f32(&network);
  return STATUS_OK;
}
