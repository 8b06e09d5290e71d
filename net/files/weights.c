// SPDX-License-Identifier: Apache-2.0
#include "net/files/weights.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "net/files/safetensors.h"
#include "net/memory.h"

static const char format[] = "tetlap-net 1";

void net_weights_card_destroy(NetCard *card) {
  net_memory_free(card->normalisation);
  net_memory_free(card->range);
  net_memory_free(card->provenance);
  *card = (NetCard){0};
}

static NetJson *make_metadata(const NetShape *shape, const NetCard *card) {
  char text[NET_SHAPE_TEXT];
  if (net_shape_print(shape, text) != NET_OK) return NULL;
  NetJson *metadata = net_json_object();
  bool ok = metadata && net_json_set_text(metadata, "format", format) &&
            net_json_set_text(metadata, "shape", text) &&
            net_json_set_text(metadata, "normalisation", card->normalisation) &&
            net_json_set_text(metadata, "range", card->range) &&
            net_json_set_text(metadata, "provenance", card->provenance);
  if (ok) return metadata;
  net_json_destroy(metadata);
  return NULL;
}

static NetStatus read_copy(const NetTensorFile *file, const char *path, const char *key, char **copy) {
  const char *text;
  NET_TRY(net_safetensors_text(file, path, key, &text));
  *copy = net_memory_text(text);
  return *copy ? NET_OK : net_status_no_memory("a network's metadata");
}

static NetStatus read_card(const NetTensorFile *file, const char *path, NetCard *card) {
  NET_TRY(read_copy(file, path, "normalisation", &card->normalisation));
  NET_TRY(read_copy(file, path, "range", &card->range));
  return read_copy(file, path, "provenance", &card->provenance);
}

static NetStatus read_shape(const NetTensorFile *file, const char *path, NetShape *shape) {
  const char *text;
  NET_TRY(net_safetensors_text(file, path, "format", &text));
  if (strcmp(text, format) != 0)
    return net_status_fail(NET_BAD_FILE, "%s: format \"%.40s\"; this program reads \"%s\"", path, text,
                           format);
  NET_TRY(net_safetensors_text(file, path, "shape", &text));
  if (net_shape_parse(text, shape) == NET_OK) return NET_OK;
  char reason[256];
  snprintf(reason, sizeof reason, "%s", net_status_message());
  return net_status_fail(NET_BAD_FILE, "%s: %s", path, reason);
}

// The file's entry for a tensor of the plan, of its shape.
static NetStatus find_entry(const NetTensorFile *file, const char *path, const NetTensor *tensor,
                            const NetEntry **entry) {
  *entry = net_safetensors_find(file, tensor->name);
  if (!*entry) return net_status_fail(NET_BAD_FILE, "%s: tensor %s is missing", path, tensor->name);
  size_t rows = (size_t)tensor->rows, columns = (size_t)tensor->columns;
  bool fits = (*entry)->rank == (columns ? 2 : 1) && (*entry)->shape[0] == rows &&
              (!columns || (*entry)->shape[1] == columns);
  if (fits) return NET_OK;
  return net_status_fail(
      NET_BAD_FILE, "%s: tensor %s has %d dimensions, %zu × %zu; its shape asks for %zu × %zu (%d)", path,
      tensor->name, (*entry)->rank, (*entry)->shape[0], (*entry)->shape[1], rows, columns, columns ? 2 : 1);
}

static NetStatus check_no_other(const NetTensorFile *file, const char *path, const NetPlan *plan) {
  for (int k = 0; k < file->count; k++)
    if (net_plan_find(plan, file->entries[k].name) < 0)
      return net_status_fail(NET_BAD_FILE, "%s: tensor %s is not part of this shape", path,
                             file->entries[k].name);
  return NET_OK;
}

// Before there is memory for its parameters: a shape is a line of text and may ask for any number of them.
static NetStatus check_tensors(const NetTensorFile *file, const char *path, const NetShape *shape) {
  NetPlan *plan = net_memory_zeroed(1, sizeof *plan);
  NetStatus status = plan ? net_plan_create(shape, plan) : net_status_no_memory("a network's plan");
  for (int k = 0; status == NET_OK && k < plan->tensor_count; k++) {
    const NetEntry *entry;
    status = find_entry(file, path, &plan->tensors[k], &entry);
  }
  net_memory_free(plan);
  return status;
}

// Element k of what may lie on any byte.
static double number_at(const NetEntry *entry, size_t k) {
  float single;
  double number;
  if (entry->number == NET_DOUBLE) {
    memcpy(&number, (const char *)entry->data + k * sizeof number, sizeof number);
    return number;
  }
  memcpy(&single, (const char *)entry->data + k * sizeof single, sizeof single);
  return (double)single;
}

#include "net/real_f32.h"

#include "net/files/weights.inc"

#include "net/real_f64.h"

#include "net/files/weights.inc"
