// SPDX-License-Identifier: Apache-2.0
// Overlap models on a device: batches of pairs, V, ∇V and flags as overlap/ops.h has them.
//
//   clip    pairs ─► clip ─ doubtful ─► clip-scalar ─ too flat ─► the host's clip-scalar: exact
//   clip32  pairs ─► clip32 ─ doubtful ─► clip ─ doubtful ─► clip-scalar ─ too flat ─► the host's
//   geo     pairs ─► gate to network; close pairs ─► clip ─► clip-scalar (geo.h) ─ no frame ─► the
//           host's geo; geo-small likewise
//   tpn     pairs ─► gate ─► network (overlap/tpn) ─ the first is flat ─► the host's exact; without x̄, and
//           flags without BEYOND; tpn-published and tpn-bf16 likewise
//
// What the host answers goes back to the device, so that all answers are there. What a pair gets is to the
// bit what the model of that name gives on a processor (clip32's doubtful ones: what `clip` gives; geo's to
// rounding, for the processor fuses multiplications and additions there), and does not depend on which others
// come with it.
#ifndef TETLAP_DEVICE_OVERLAP_OVERLAP_H
#define TETLAP_DEVICE_OVERLAP_OVERLAP_H

#include "device/overlap/state.h"

enum { DEVICE_OVERLAP_MODELS = 7 };
extern const char *const device_overlap_models[DEVICE_OVERLAP_MODELS]; // names

// A zeroed one, and one whose creation failed, can be destroyed. STATUS_USAGE: no kernels for that model.
Status device_overlap_create(DeviceOverlap *overlap, const Device *device, const char *model);
void device_overlap_destroy(DeviceOverlap *overlap);

// Whether the model gives that on a device: V and ∇V all, x̄ not all.
bool device_overlap_gives(const char *model, DeviceQuantity quantity);

// What a pair takes: of a network, which not all pairs are asked (flop_pairs), multiplications and additions
// of its products, with the way back for ∇V (of geo without the last layer, a hundredth); of clipping all
// arithmetic of the first kernel, a fused operation twice, comparisons and choices not. In which numbers; the
// name of the network's weights, NULL: there is none.
double device_overlap_flops(const DeviceOverlap *overlap, DeviceQuantity quantity);
// The instructions that this arithmetic takes at least: a fused operation is one. 0: products are those of
// tensor cores, which is not counted.
double device_overlap_instructions(const DeviceOverlap *overlap, DeviceQuantity quantity);
DeviceArithmetic device_overlap_arithmetic(const DeviceOverlap *overlap);
const char *device_overlap_weights(const DeviceOverlap *overlap);

// What the next evaluations are of: sent to the device, where it stays.
Status device_overlap_put_columns(DeviceOverlap *overlap, int count, const double *pairs);
// positions (vertex_count, 3), tets (tet_count, 4), pairs (count, 2): tetrahedra.
Status device_overlap_put_mesh(DeviceOverlap *overlap, int vertex_count, const double *positions,
                               int tet_count, const int *tets, int count, const int *pairs);

// Evaluates what was put; the answers stay on the device.
Status device_overlap_run(DeviceOverlap *overlap, DeviceQuantity quantity);

// The answers: volume (count); `more`, ∇V or x̄ as the pairs lie, and flags (count) may be NULL.
Status device_overlap_get(DeviceOverlap *overlap, double *volume, double *more, unsigned *flags);

// All of it: a batch of the host's, without Hessian; ∇V or x̄, not both.
Status device_overlap_eval(DeviceOverlap *overlap, const OverlapBatch *batch);

#endif
