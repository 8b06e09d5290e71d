// SPDX-License-Identifier: Apache-2.0
// A TetrahedronPairNet as the steps and numbers that kernels/tpn/tpn.inc carries out: the shipped `tpn` and
// `tpn-published`, folded. For V rows of the group's memory are given to the matrices of a pass by how long
// each is needed; for ∇V all stay, with the derivatives behind them.
#ifndef TETLAP_DEVICE_NETWORK_TPN_H
#define TETLAP_DEVICE_NETWORK_TPN_H

#include "device/device.h"

// A pass of kernels/tpn/tpn.inc; there, PASS_…, STEP_…, VIEW_….
typedef struct DeviceTpnPass {
  DeviceMemory sizes, steps, views;
} DeviceTpnPass;

typedef struct DeviceTpn {
  DeviceTpnPass volume, gradient;
  DeviceMemory parameters, packed; // packed: weights as fragments (pack.h), of bf16
  DeviceMemory shown, factor;      // of a batch's pairs: rows of kernels/tpn/steps.h, |det E|
  int room;                        // numbers of a row
  int normalisation;
  double scale; // the network's output is this times V'
  double flops; // multiplications and additions of the products of a pair's V
} DeviceTpn;

// `weights`: the name of weights that ship; `is_bf16`: for the program that rounds factors. A zeroed one, and
// one whose creation failed, can be destroyed. STATUS_INPUT: a network that the kernels cannot carry out, and
// why.
Status device_tpn_create(DeviceTpn *tpn, const Device *device, const char *weights, bool is_bf16);
void device_tpn_destroy(DeviceTpn *tpn, const Device *device);

// Room for `count` pairs.
Status device_tpn_make_room(DeviceTpn *tpn, const Device *device, int count);

// Write arguments of kernels, and return how many: what is known of pairs; those of the network's kernels.
int device_tpn_table(const DeviceTpn *tpn, DeviceArgument *arguments);
int device_tpn_arguments(const DeviceTpn *tpn, bool has_gradient, int count, DeviceArgument *arguments);

// Groups that so many pairs take.
int device_tpn_groups(bool has_gradient, int count);

#endif
