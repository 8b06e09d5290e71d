// SPDX-License-Identifier: Apache-2.0
#include "device/overlap/geo.h"

#include <string.h>

#include "device/kernels/geo/rows.h"
#include "device/overlap/stage.h"

enum { GATE, FRAME, FEATURES, NETWORK, VOLUME, BLEND = 7, PULL }; // of the first stage's program
enum { CLIP = 1, SCALAR = 2 };                                    // stages

static const int widths[] = {0, 24, 3}; // numbers beside V, of DeviceQuantity

static Status launch(const DeviceOverlap *overlap, int which, int count, const DeviceArgument *arguments,
                     int n) {
  return device_launch(overlap->device, &overlap->stages[0].kernels[which], count, arguments, n);
}

// Pairs first … end − 1; how many of them intersect.
static Status run_gate(DeviceOverlap *overlap, int first, int end, DeviceQuantity quantity, int *inside) {
  const DeviceGeo *geo = &overlap->geo;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, end, NULL, arguments);
  const DeviceArgument given[] = {device_int(first),
                                  device_memory(&overlap->volume),
                                  device_memory(&overlap->flags),
                                  device_int(widths[quantity]),
                                  device_memory(&overlap->more),
                                  device_memory(&overlap->lists[0]),
                                  device_memory(&overlap->list_count),
                                  device_memory(&geo->slots),
                                  device_memory(&geo->slot_count),
                                  device_memory(&geo->table),
                                  device_int(DEVICE_GEO_ROOM)};
  memcpy(arguments + n, given, sizeof given);
  n += (int)(sizeof given / sizeof *given);
  TRY(device_overlap_reset(overlap, &geo->slot_count));
  TRY(device_overlap_begin(overlap));
  TRY(launch(overlap, GATE, end - first, arguments, n));
  TRY(device_overlap_end_gate(overlap));
  return device_overlap_count(overlap, &geo->slot_count, inside);
}

// Frame to the network's outputs, and for ∇V to Φ, of `count` slots.
static Status run_network(const DeviceOverlap *overlap, int count, DeviceQuantity quantity) {
  const DeviceGeo *geo = &overlap->geo;
  const DeviceArgument frame[] = {
      device_int(count),           device_memory(&geo->slots),        device_memory(&geo->table),
      device_int(DEVICE_GEO_ROOM), device_memory(&overlap->lists[0]), device_memory(&overlap->list_count)};
  const DeviceArgument features[] = {device_int(count), device_memory(&geo->table),
                                     device_int(DEVICE_GEO_ROOM)};
  const DeviceArgument network[] = {device_int(count),
                                    device_memory(&geo->table),
                                    device_int(DEVICE_GEO_ROOM),
                                    device_memory(&geo->layers),
                                    device_int(geo->layer_count),
                                    device_memory(&geo->parameters),
                                    device_int(quantity == DEVICE_CENTROID ? geo->output_count : 1),
                                    device_int(quantity == DEVICE_GRADIENT)};
  const Device *device = overlap->device;
  const int groups = count / GEO_COLUMNS + (count % GEO_COLUMNS > 0);
  TRY(launch(overlap, FRAME, count, frame, sizeof frame / sizeof *frame));
  TRY(launch(overlap, FEATURES, count, features, sizeof features / sizeof *features));
  TRY(device->ops->launch(device->self, &overlap->stages[0].kernels[NETWORK], groups, network,
                          sizeof network / sizeof *network));
  if (quantity != DEVICE_GRADIENT) return STATUS_OK;
  return launch(overlap, PULL, count, features, sizeof features / sizeof *features);
}

static Status write_answers(const DeviceOverlap *overlap, int count, DeviceQuantity quantity) {
  const DeviceGeo *geo = &overlap->geo;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, count, NULL, arguments);
  const DeviceArgument given[] = {device_memory(&geo->slots),          device_memory(&geo->table),
                                  device_int(DEVICE_GEO_ROOM),         device_double(geo->offset),
                                  device_memory(&overlap->volume),     device_memory(&overlap->lists[0]),
                                  device_memory(&overlap->list_count), device_memory(&geo->close),
                                  device_memory(&geo->close_count),    device_memory(&geo->clipped)};
  memcpy(arguments + n, given, sizeof given);
  n += (int)(sizeof given / sizeof *given);
  if (quantity != DEVICE_VOLUME) arguments[n++] = device_memory(&overlap->more);
  return launch(overlap, VOLUME + (int)quantity, count, arguments, n);
}

// All of `count` slots but the blend; how many pairs are close.
static Status run_slots(DeviceOverlap *overlap, int count, DeviceQuantity quantity, int *close) {
  const DeviceGeo *geo = &overlap->geo;
  TRY(device_overlap_reset(overlap, &geo->close_count));
  TRY(device_overlap_begin(overlap));
  TRY(run_network(overlap, count, quantity));
  TRY(write_answers(overlap, count, quantity));
  TRY(device_overlap_end(overlap));
  return device_overlap_count(overlap, &geo->close_count, close);
}

// clip's answers to the close pairs. What both leave stays NaN.
static Status clip_close(DeviceOverlap *overlap, int count, DeviceQuantity quantity) {
  const DeviceGeo *geo = &overlap->geo;
  const DeviceMemory *lists[] = {&geo->close, &geo->left, &overlap->lists[1]};
  int left = count;
  for (int k = CLIP; k <= SCALAR && left > 0; k++) {
    const DeviceOverlapAnswers answers = {&geo->clipped, &geo->clipped_flags, &geo->clipped_more, lists[k],
                                          &geo->left_count};
    overlap->handed_on[k - 1] += left;
    TRY(device_overlap_stage(overlap, k, left, lists[k - 1], quantity, &answers, &left));
  }
  return STATUS_OK;
}

static Status blend(DeviceOverlap *overlap, int count, DeviceQuantity quantity) {
  const DeviceGeo *geo = &overlap->geo;
  const DeviceArgument arguments[] = {device_int((int)overlap->kind),    device_int(count),
                                      device_int(overlap->count),        device_memory(&geo->close),
                                      device_memory(&geo->table),        device_int(DEVICE_GEO_ROOM),
                                      device_int(widths[quantity]),      device_memory(&overlap->volume),
                                      device_memory(&overlap->more),     device_memory(&overlap->flags),
                                      device_memory(&geo->clipped),      device_memory(&geo->clipped_more),
                                      device_memory(&overlap->lists[0]), device_memory(&overlap->list_count)};
  TRY(device_overlap_begin(overlap));
  TRY(launch(overlap, BLEND, count, arguments, sizeof arguments / sizeof *arguments));
  return device_overlap_end(overlap);
}

Status device_overlap_geo_run(DeviceOverlap *overlap, DeviceQuantity quantity, int *left) {
  TRY(device_geo_make_room(&overlap->geo, overlap->device, overlap->capacity, widths[quantity]));
  TRY(device_overlap_reset(overlap, &overlap->list_count));
  for (int first = 0; first < overlap->count; first += DEVICE_GEO_ROOM) {
    const int rest = overlap->count - first, end = first + (rest < DEVICE_GEO_ROOM ? rest : DEVICE_GEO_ROOM);
    int inside = 0, close = 0;
    TRY(run_gate(overlap, first, end, quantity, &inside));
    overlap->flop_pairs += inside;
    if (inside > 0) TRY(run_slots(overlap, inside, quantity, &close));
    if (close == 0) continue;
    TRY(clip_close(overlap, close, quantity));
    TRY(blend(overlap, close, quantity));
  }
  TRY(device_overlap_count(overlap, &overlap->list_count, left));
  overlap->handed_on[SCALAR] = *left;
  return STATUS_OK;
}
