// SPDX-License-Identifier: Apache-2.0
// What the kernels of geo and geo-small need on a device: the network, and memory of a pass. Pairs are taken
// DEVICE_GEO_ROOM at a time; kernels/geo/rows.h says what is kept of each.
#ifndef TETLAP_DEVICE_NETWORK_GEO_H
#define TETLAP_DEVICE_NETWORK_GEO_H

#include "device/device.h"
#include "overlap/model.h"

enum { DEVICE_GEO_ROOM = 1 << 16 };

typedef struct DeviceGeo {
  OverlapModel host; // answers what is left
  int feature_count, output_count, layer_count;
  double offset; // φ = ρ + offset
  double flops;  // multiplications and additions of the products of all layers but the last, of a pair
  DeviceMemory layers, parameters;
  DeviceMemory table, slots, slot_count;
  DeviceMemory close, close_count, left, left_count; // pairs that clip answers, too; what it leaves
  DeviceMemory clipped, clipped_more, clipped_flags; // clip's answers, by pair
} DeviceGeo;

// `name`: geo or geo-small, whose kernels have so many features. A zeroed one, and one whose creation failed,
// can be destroyed. STATUS_INPUT: weights that the kernels cannot carry out, and why.
Status device_geo_create(DeviceGeo *geo, const Device *device, const char *name, int feature_count);
void device_geo_destroy(DeviceGeo *geo, const Device *device);

// Room for clip's answers to `count` pairs, with `width` numbers beside V.
Status device_geo_make_room(DeviceGeo *geo, const Device *device, int count, int width);

#endif
