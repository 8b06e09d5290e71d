// SPDX-License-Identifier: Apache-2.0
#include "net/files/checkpoint.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "net/files/safetensors.h"
#include "net/memory.h"

static const char format[] = "tetlap-checkpoint 1";

// Numbers in metadata: doubles as hexadecimal, which is exact.
static bool set_double(NetJson *metadata, const char *key, double number) {
  char text[40];
  snprintf(text, sizeof text, "%a", number);
  return net_json_set_text(metadata, key, text);
}

static bool set_integer(NetJson *metadata, const char *key, int64_t number) {
  char text[40];
  snprintf(text, sizeof text, "%" PRId64, number);
  return net_json_set_text(metadata, key, text);
}

static bool set_random(NetJson *metadata, const NetRandom *random) {
  char text[80];
  snprintf(text, sizeof text, "%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64, random->state[0],
           random->state[1], random->state[2], random->state[3]);
  return net_json_set_text(metadata, "random", text);
}

static NetStatus refuse(const char *path, const char *key, const char *text) {
  return net_status_fail(NET_BAD_FILE, "%s: metadata \"%s\" is \"%.40s\", no number", path, key, text);
}

static NetStatus read_double(const NetTensorFile *file, const char *path, const char *key, double *number) {
  const char *text;
  int used = 0;
  NET_TRY(net_safetensors_text(file, path, key, &text));
  bool ok = sscanf(text, "%la%n", number, &used) == 1 && !text[used];
  return ok ? NET_OK : refuse(path, key, text);
}

static NetStatus read_integer(const NetTensorFile *file, const char *path, const char *key, int64_t *number) {
  const char *text;
  int used = 0;
  NET_TRY(net_safetensors_text(file, path, key, &text));
  bool ok = sscanf(text, "%" SCNd64 "%n", number, &used) == 1 && !text[used];
  return ok ? NET_OK : refuse(path, key, text);
}

static NetStatus read_random(const NetTensorFile *file, const char *path, NetRandom *random) {
  const char *text;
  int used = 0;
  uint64_t *s = random->state;
  NET_TRY(net_safetensors_text(file, path, "random", &text));
  bool ok = sscanf(text, "%" SCNx64 " %" SCNx64 " %" SCNx64 " %" SCNx64 "%n", &s[0], &s[1], &s[2], &s[3],
                   &used) == 4 &&
            !text[used];
  return ok ? NET_OK : refuse(path, "random", text);
}

static bool set_schedule(NetJson *metadata, const NetSchedule *schedule) {
  return set_double(metadata, "schedule.peak", schedule->peak) &&
         set_double(metadata, "schedule.final", schedule->final) &&
         set_integer(metadata, "schedule.warmup_steps", schedule->warmup_steps) &&
         set_integer(metadata, "schedule.total_steps", schedule->total_steps);
}

static NetStatus read_schedule(const NetTensorFile *file, const char *path, NetSchedule *schedule) {
  NET_TRY(read_double(file, path, "schedule.peak", &schedule->peak));
  NET_TRY(read_double(file, path, "schedule.final", &schedule->final));
  NET_TRY(read_integer(file, path, "schedule.warmup_steps", &schedule->warmup_steps));
  return read_integer(file, path, "schedule.total_steps", &schedule->total_steps);
}

static bool set_adam(NetJson *metadata, const NetAdamDef *def, int64_t step) {
  return set_double(metadata, "adam.beta1", def->beta1) && set_double(metadata, "adam.beta2", def->beta2) &&
         set_double(metadata, "adam.epsilon", def->epsilon) &&
         set_double(metadata, "adam.weight_decay", def->weight_decay) &&
         set_integer(metadata, "adam.step", step);
}

static NetStatus read_adam(const NetTensorFile *file, const char *path, NetAdamDef *def, int64_t *step) {
  NET_TRY(read_double(file, path, "adam.beta1", &def->beta1));
  NET_TRY(read_double(file, path, "adam.beta2", &def->beta2));
  NET_TRY(read_double(file, path, "adam.epsilon", &def->epsilon));
  NET_TRY(read_double(file, path, "adam.weight_decay", &def->weight_decay));
  return read_integer(file, path, "adam.step", step);
}

static NetEntry make_entry(const char *name, NetNumber number, size_t rows, size_t columns,
                           const void *data) {
  NetEntry entry = {.number = number, .rank = columns ? 2 : 1, .shape = {rows, columns}, .data = data};
  snprintf(entry.name, sizeof entry.name, "%s", name);
  return entry;
}

static NetStatus read_numbers(const NetTensorFile *file, const char *path, const char *name, NetNumber number,
                              size_t count, void *data) {
  const NetEntry *entry = net_safetensors_find(file, name);
  if (!entry) return net_status_fail(NET_BAD_FILE, "%s: tensor %s is missing", path, name);
  if (entry->number != number)
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s is in another precision than this training", path,
                           name);
  if (net_safetensors_size(entry) != count)
    return net_status_fail(NET_BAD_FILE, "%s: tensor %s has %zu elements; expected %zu", path, name,
                           net_safetensors_size(entry), count);
  memcpy(data, entry->data, net_safetensors_bytes(entry));
  return NET_OK;
}

static NetStatus read_whitening(const NetTensorFile *file, const char *path, NetWhitening *whitening) {
  const NetEntry *mean = net_safetensors_find(file, "whitening.mean");
  if (!mean) return NET_OK;
  size_t count = net_safetensors_size(mean);
  if (count > NET_MAX_WIDTH)
    return net_status_fail(NET_BAD_FILE, "%s: a whitening of %zu features; at most %d are possible", path,
                           count, NET_MAX_WIDTH);
  NET_TRY(net_whitening_create((int)count, whitening));
  NET_TRY(read_numbers(file, path, "whitening.mean", NET_DOUBLE, count, whitening->mean));
  return read_numbers(file, path, "whitening.matrix", NET_DOUBLE, count * count, whitening->matrix);
}

static NetStatus check_shape(const NetTensorFile *file, const char *path, const NetShape *expected) {
  const char *text;
  NetShape shape;
  NET_TRY(net_safetensors_text(file, path, "format", &text));
  if (strcmp(text, format) != 0)
    return net_status_fail(NET_BAD_FILE, "%s: format \"%.40s\"; expected \"%s\"", path, text, format);
  NET_TRY(net_safetensors_text(file, path, "shape", &text));
  NET_TRY(net_shape_parse(text, &shape));
  if (net_shape_equal(&shape, expected)) return NET_OK;
  return net_status_fail(NET_BAD_FILE, "%s: the checkpoint is of a network of another shape: %.300s", path,
                         text);
}

#include "net/real_f32.h"

#include "net/files/checkpoint.inc"

#include "net/real_f64.h"

#include "net/files/checkpoint.inc"
