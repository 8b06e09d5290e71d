// SPDX-License-Identifier: GPL-3.0-or-later
// Weights files: safetensors with a network's shape in its header. Read in both precisions, and as an overlap
// model; what is accepted is evaluated.
#include <stdlib.h>
#include <string.h>

#include "datagen/hard.h"
#include "net/files/weights.h"
#include "overlap/geo/network.h"
#include "overlap/models.h"
#include "overlap/tpn/network.h"
#include "overlap/weights.h"
#include "target.h"

static const char file_name[] = "fuzz.safetensors";

static void check_refusal(NetStatus status, const char *path) {
  FUZZ_CLAIM(status == NET_BAD_FILE || status == NET_BAD_ARGUMENT, "status %d: %s", (int)status,
             net_status_message());
  FUZZ_CLAIM(strstr(net_status_message(), path), "no path in '%s'", net_status_message());
}

// The same network in both precisions, or the same refusal.
static void read_both(const char *path) {
  NetModel_f32 single;
  NetModel_f64 number;
  NetCard card, again;
  NetStatus in_double = net_weights_read_f64(path, &number, &card),
            in_single = net_weights_read_f32(path, &single, &again);
  if (in_double) check_refusal(in_double, path);
  if (in_single) check_refusal(in_single, path);
  // A double may be too large for a float.
  FUZZ_CLAIM(!in_double || in_single, "double %d, single %d", (int)in_double, (int)in_single);
  if (!in_single)
    FUZZ_CLAIM(net_shape_equal(&single.plan->shape, &number.plan->shape) &&
                   strcmp(card.provenance, again.provenance) == 0,
               "two readings of one file differ");
  net_model_destroy_f64(&number);
  net_model_destroy_f32(&single);
  net_weights_card_destroy(&card);
  net_weights_card_destroy(&again);
}

// Weights are any finite numbers, so the volumes may be, too: nothing is claimed of them.
static void read_model(const char *path) {
  OverlapModel model;
  Status status = overlap_models_create(&model, path);
  if (status) {
    FUZZ_CLAIM(status == STATUS_INPUT, "status %d: %s", (int)status, status_message());
    FUZZ_CLAIM(strstr(status_message(), path), "no path in '%s'", status_message());
    return;
  }
  DatagenHardPair pair = datagen_hard_make(0, 0);
  double volume, gradient[24];
  OverlapBatch batch = {.pair_count = 1, .pairs = pair.x, .volume = &volume, .gradient = gradient};
  overlap_model_eval(&model, &batch);
  overlap_model_destroy(&model);
}

static void run(const uint8_t *data, size_t size) {
  const char *path = fuzz_target_file(file_name, data, size);
  read_both(path);
  read_model(path);
}

// Small networks of each kind.
static NetShape shape_of(int k) {
  if (k == 0) return net_shape_mlp(36, 1, 1, 1);
  if (k == 1) return net_shape_mlp(36, 2, 2, 1);
  NetShape shape = k % 2 ? net_shape_tpn_a() : net_shape_tpn_b();
  NetWidths *const blocks[] = {&shape.vertex,   &shape.tetrahedron, &shape.combiner,
                               &shape.backbone, &shape.status_head, &shape.volume_head};
  for (size_t b = 0; b < sizeof blocks / sizeof *blocks; b++) {
    if (blocks[b]->count > 1) blocks[b]->count = 1;
    for (int d = 0; d < blocks[b]->count; d++) blocks[b]->width[d] = 2;
  }
  return shape;
}

static void write_seed(int k, const char *path) {
  NetShape shape = shape_of(k);
  char normalisation[OVERLAP_TPN_NORMALISATION_TEXT] = OVERLAP_GEO_NORMALISATION, range[] = "",
       provenance[] = "a seed";
  if (shape.kind == NET_TPN) overlap_tpn_network_print(OVERLAP_TPN_NORMALISE_UNIT, 1000, normalisation);
  NetCard card = {normalisation, range, provenance};
  NetModel_f64 number = {0};
  NetModel_f32 single = {0};
  NetStatus status;
  if (k % 3) {
    status = net_model_create_f64(&shape, &number);
    if (!status) net_model_initialise_f64(&number, 1);
    if (!status) status = net_weights_write_f64(path, &number, &card);
  } else {
    status = net_model_create_f32(&shape, &single);
    if (!status) net_model_initialise_f32(&single, 1);
    if (!status) status = net_weights_write_f32(path, &single, &card);
  }
  FUZZ_CLAIM(!status, "%s", net_status_message());
  net_model_destroy_f64(&number);
  net_model_destroy_f32(&single);
}

static size_t seed(int k, uint8_t *data) {
  enum { SMALL = 6 };
  if (k > SMALL) return 0;
  if (k == SMALL) return fuzz_target_source("net/weights/geo-small.safetensors", data, FUZZ_MAX_INPUT);
  const char *path = fuzz_target_file(file_name, "", 0);
  write_seed(k, path);
  return fuzz_target_read(path, data, FUZZ_MAX_INPUT);
}

// Of a file its first eight bytes say how long the header is. A mutation of the text keeps that true, or few
// files would come as far as their content.
static size_t mutate(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain) {
  uint64_t length;
  if (number % 8 == 0 || size < sizeof length) return plain(data, size, room);
  memcpy(&length, data, sizeof length);
  if (length > size - sizeof length) return plain(data, size, room);
  size_t behind = size - sizeof length - (size_t)length;
  if (number % 8 == 1) // the numbers
    return size - behind + plain(data + size - behind, behind, room - (size - behind));
  uint8_t *numbers = malloc(behind ? behind : 1);
  if (!numbers || room <= sizeof length + behind) {
    free(numbers);
    return plain(data, size, room);
  }
  memcpy(numbers, data + size - behind, behind);
  length = plain(data + sizeof length, (size_t)length, room - sizeof length - behind);
  memcpy(data, &length, sizeof length);
  memcpy(data + sizeof length + length, numbers, behind);
  free(numbers);
  return sizeof length + (size_t)length + behind;
}

const FuzzTarget fuzz_weights = {.name = "weights", .run = run, .seed = seed, .mutate = mutate};
