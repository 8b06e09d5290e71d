// SPDX-License-Identifier: Apache-2.0
#include "overlap/weights.h"

#include <stdio.h>
#include <string.h>

#include "base/files/data.h"
#include "net/files/weights.h"

static const char ENDING[] = ".safetensors";
static const char KNOWN[] = "geo", KNOWN_FILE[] = "net/weights/geo.safetensors"; // always shipped

bool overlap_weights_is_path(const char *name) {
  return strpbrk(name, "./") != NULL; // names of the program's own models have neither
}

Status overlap_weights_find(const char *name, char *path, size_t size) {
  char file[256];
  int length = snprintf(file, sizeof file, "net/weights/%s%s", name, ENDING);
  if (length < 0 || (size_t)length >= sizeof file)
    return status_fail(STATUS_INPUT, "%s: the name is too long", name);
  Status status = data_find(file, path, size);
  if (status != STATUS_IO) return status;
  if (strcmp(name, KNOWN) != 0 && data_find(KNOWN_FILE, path, size) == STATUS_OK) // the folder is there
    return status_fail(
        STATUS_IO, "there are no weights '%s' in tetlap; for a file of your own give its path, as in ./%s%s",
        name, name, ENDING);
  data_find(file, path, size);
  return status_prefix(status, "the weights of '%s'", name);
}

Status overlap_weights_kind(const char *path, OverlapWeightsKind *kind) {
  NetModel_f32 network;
  NetCard card;
  NetStatus status = net_weights_read_f32(path, &network, &card);
  if (status != NET_OK) // names the path
    return status_fail(status == NET_NO_MEMORY ? STATUS_MEMORY
                       : status == NET_BAD_IO  ? STATUS_IO
                                               : STATUS_INPUT,
                       "%s", net_status_message());
  *kind = network.plan->shape.kind == NET_TPN ? OVERLAP_WEIGHTS_TPN : OVERLAP_WEIGHTS_GEO;
  net_weights_card_destroy(&card);
  net_model_destroy_f32(&network);
  return STATUS_OK;
}
