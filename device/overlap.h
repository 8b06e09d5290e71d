// SPDX-License-Identifier: Apache-2.0
// Overlap models on a device: batches of pairs, V, ∇V and flags as overlap/ops.h has them.
//
//   clip    pairs ─► clip ─ doubtful ─► clip-scalar ─ too flat ─► the host's clip-scalar: exact
//   clip32  pairs ─► clip32 ─ doubtful ─► clip ─ doubtful ─► clip-scalar ─ too flat ─► the host's
//   geo     pairs ─► gate to network; close pairs ─► clip ─► clip-scalar (overlap_geo.h) ─ no frame ─► the
//           host's geo; geo-small likewise
//   tpn     pairs ─► tpn ─ the first is flat ─► the host's exact; V only, and flags without BEYOND
//
// What the host answers goes back to the device, so that all answers are there. What a pair gets is to the
// bit what the model of that name gives on a processor (clip32's doubtful ones: what `clip` gives; geo's to
// rounding, for the processor fuses multiplications and additions there), and does not depend on which others
// come with it.
#ifndef TETLAP_DEVICE_OVERLAP_H
#define TETLAP_DEVICE_OVERLAP_H

#include "device/device.h"
#include "device/geo.h"
#include "device/tpn.h"
#include "overlap/ops.h"

// Where a batch's numbers lie; as PAIRS_… in kernels/pairs.inc.
typedef enum DevicePairs {
  DEVICE_PAIRS_ROWS,    // (count, 24), gradients likewise
  DEVICE_PAIRS_COLUMNS, // (24, count), gradients likewise
  DEVICE_PAIRS_INDICES, // positions, tetrahedra, and two tetrahedra a pair; gradients (24, count)
} DevicePairs;

enum { DEVICE_OVERLAP_STAGES = 3, DEVICE_OVERLAP_MODELS = 5 };
extern const char *const device_overlap_models[DEVICE_OVERLAP_MODELS]; // names

// What is wanted of a batch; as the kernels of a program are listed.
typedef enum DeviceQuantity { DEVICE_VOLUME, DEVICE_GRADIENT, DEVICE_CENTROID } DeviceQuantity;

typedef struct DeviceOverlapStage {
  void *module; // owned
  DeviceKernel kernels[DEVICE_MAX_KERNELS];
} DeviceOverlapStage;

typedef struct DeviceOverlap {
  const Device *device;                   // borrowed
  const struct DeviceOverlapChain *chain; // borrowed
  int stage_count;
  DeviceTpn tpn;     // the network, where there is one
  DeviceGeo geo;     // likewise
  OverlapModel host; // answers on the host what is left; self borrowed
  DeviceOverlapStage stages[DEVICE_OVERLAP_STAGES], gather;
  DevicePairs kind;
  DeviceQuantity last; // what was evaluated last
  int count, capacity; // pairs: of the batch, and the most there may be
  DeviceMemory numbers, tets, pairs;
  DeviceMemory volume, more, flags;                   // answers; more: ∇V or x̄; flags are one byte each
  DeviceMemory lists[2], list_count;                  // doubtful pairs
  DeviceMemory rows, row_volume, row_more, row_flags; // what the host answers
  int row_capacity;
  double kernel_s;                      // of the last batch: what the stages' kernels took [s]
  int handed_on[DEVICE_OVERLAP_STAGES]; // of the last batch: pairs that stage k left to the next, or the host
} DeviceOverlap;

// A zeroed one, and one whose creation failed, can be destroyed. STATUS_USAGE: no kernels for that model.
Status device_overlap_create(DeviceOverlap *overlap, const Device *device, const char *model);
void device_overlap_destroy(DeviceOverlap *overlap);

// Whether ∇V and x̄ are to be had beside V.
bool device_overlap_has_more(const char *model);

// What the next evaluations are of: sent to the device, where it stays.
Status device_overlap_put_rows(DeviceOverlap *overlap, int count, const double *pairs);
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
