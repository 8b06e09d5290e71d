// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels for devices as plain C, on any pair of tetrahedra: V, ∇V, x̄ and flags against the model of the same
// name on this processor, carried out in the same order of sums.
//
//   clip, tpn, tpn-published, tpn-bf16   to the bit
//   clip32                               to the bit: doubtful pairs those of clip
//   geo-small, geo                       flags but who answered to the bit, V to 1e-12 of the smaller
//                                        tetrahedron's and some last digits of coordinates; ∇V and x̄ by their
//                                        size
//
// and a pair gets the same bits in whichever place of a batch. Numbers that are not finite must be refused.
#include <float.h>
#include <math.h>
#include <string.h>

#include "device/overlap/overlap.h"
#include "net/kernel/bf16.h"
#include "overlap/clip/lanes.h"
#include "overlap/geo/model.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/tpn/portion.h"
#include "pairs.h"
#include "target.h"

enum { SIZE = OVERLAP_PAIR_SIZE, PAIR_BYTES = SIZE * sizeof(double), PLACES = 3, QUANTITIES = 3 };

static const int widths[QUANTITIES] = {0, SIZE, 3}; // numbers beside V, of DeviceQuantity

typedef struct Batch {
  double volume[PLACES], more[PLACES * SIZE];
  unsigned flags[PLACES];
} Batch;

// A model: on the processor, and its kernels.
typedef struct Contestant {
  OverlapModel model;
  DeviceOverlap kernels;
} Contestant;

static const char *name_of(int m) {
  return device_overlap_models[m];
}

static bool is_geo(int m) {
  return strncmp(name_of(m), "geo", 3) == 0;
}

static bool is_clip(int m) {
  return strncmp(name_of(m), "clip", 4) == 0;
}

// The order of sums that kernels have.
static void use_order_of_kernels(int m, const OverlapModel *model) {
  if (is_geo(m)) ((OverlapGeoOverlap *)model->self)->model.kernel = &overlap_geo_bundle_kernel_portable;
  if (strcmp(name_of(m), "tpn-bf16") != 0) return;
  const OverlapTpnNetwork *network = &((OverlapTpnModel *)model->self)->model;
  for (int k = 0; k < network->workspace_count; k++)
    network->workspaces[k].work.kernel = &net_kernel_bf16_emulated;
}

static Contestant *contestant_of(int m) {
  static Contestant contestants[DEVICE_OVERLAP_MODELS];
  static Device device;
  Contestant *contestant = &contestants[m];
  if (!device.ops) FUZZ_CLAIM(device_open(&device, "host") == STATUS_OK, "%s", status_message());
  if (contestant->model.ops) return contestant;
  FUZZ_CLAIM(overlap_models_create(&contestant->model, name_of(m)) == STATUS_OK, "%s", status_message());
  FUZZ_CLAIM(device_overlap_create(&contestant->kernels, &device, name_of(m)) == STATUS_OK, "%s",
             status_message());
  use_order_of_kernels(m, &contestant->model);
  return contestant;
}

static OverlapBatch batch_of(const double *pairs, int count, int quantity, Batch *batch) {
  return (OverlapBatch){.pair_count = count,
                        .pairs = pairs,
                        .volume = batch->volume,
                        .gradient = quantity == DEVICE_GRADIENT ? batch->more : NULL,
                        .centroid = quantity == DEVICE_CENTROID ? batch->more : NULL,
                        .flags = batch->flags};
}

static void ask_model(int m, const double *pairs, int quantity, Batch *batch) {
  const OverlapBatch asked = batch_of(pairs, PLACES, quantity, batch);
  FUZZ_CLAIM(overlap_model_eval(&contestant_of(m)->model, &asked) == STATUS_OK, "%s: %s", name_of(m),
             status_message());
}

static void ask_kernels(int m, const double *pairs, int quantity, Batch *batch) {
  const OverlapBatch asked = batch_of(pairs, PLACES, quantity, batch);
  FUZZ_CLAIM(device_overlap_eval(&contestant_of(m)->kernels, &asked) == STATUS_OK, "kernels of %s: %s",
             name_of(m), status_message());
}

static bool is_same(const Batch *a, const Batch *b, int i, int width) {
  // a device does not tell pairs unlike those that a network was trained on
  const unsigned untold = b->flags[i] & OVERLAP_NET ? OVERLAP_BEYOND : 0;
  return a->flags[i] == (b->flags[i] & ~untold) &&
         memcmp(&a->volume[i], &b->volume[i], sizeof(double)) == 0 &&
         memcmp(a->more + width * i, b->more + width * i, (size_t)width * sizeof(double)) == 0;
}

static void check_bits(int m, const double *pairs, int quantity, const Batch *told, const Batch *expected) {
  static Batch careful;
  const bool is_single = strcmp(name_of(m), "clip32") == 0;
  if (is_single) ask_model(0, pairs, quantity, &careful);
  for (int i = 0; i < PLACES; i++)
    FUZZ_CLAIM(is_same(told, expected, i, widths[quantity]) ||
                   (is_single && is_same(told, &careful, i, widths[quantity])),
               "kernels of %s, quantity %d, place %d: V = %.17g, flags %u; the model %.17g, flags %u",
               name_of(m), quantity, i, told->volume[i], told->flags[i], expected->volume[i],
               expected->flags[i]);
}

// What V of a slice is rounded by, as a share of it: 1e-15 of the smaller volume. ∇V and x̄ divide by how
// thick the slice is.
static double doubt_of(const double x[SIZE], double volume) {
  return volume > 0 ? 1e-15 * overlap_invariant_smaller_volume(x) / volume : 0;
}

static double furthest_of(const double x[SIZE]) {
  double furthest = 0;
  for (int c = 0; c < SIZE; c++) furthest = fmax(furthest, fabs(x[c]));
  return furthest;
}

// The smaller volume's share, and what some last digits of the coordinates change: their size times an area.
static double volume_allowed(const double x[SIZE]) {
  const double extent = overlap_invariant_extent(x);
  return 1e-12 * overlap_invariant_smaller_volume(x) + 8 * DBL_EPSILON * furthest_of(x) * extent * extent;
}

// V, ∇V and x̄ by V, the largest component, and the pair's extent. A coordinate of x̄ is rounded, too.
static double allowed_of(const double x[SIZE], int quantity, double volume, const double *more) {
  const double doubt = doubt_of(x, volume);
  double largest = 0;
  if (quantity == DEVICE_CENTROID)
    return (1e-12 + 100 * doubt) * overlap_invariant_extent(x) + 4 * DBL_EPSILON * furthest_of(x);
  for (int c = 0; c < SIZE; c++) largest = fmax(largest, fabs(more[c]));
  return (1e-10 + 100 * doubt) * largest;
}

static void check_rounding(int m, const double *pairs, int quantity, const Batch *told,
                           const Batch *expected) {
  const int width = widths[quantity];
  for (int i = 0; i < PLACES; i++) {
    const double *x = pairs + SIZE * i, *a = told->more + width * i, *b = expected->more + width * i;
    const double volume = expected->volume[i];
    // At an edge of the band in which V is blended rounding decides who answers, and V is the same.
    const unsigned sure = ~(unsigned)(OVERLAP_FALLBACK | OVERLAP_BLENDED);
    FUZZ_CLAIM((told->flags[i] & sure) == (expected->flags[i] & sure),
               "kernels of %s, place %d: flags %u; the model %u", name_of(m), i, told->flags[i],
               expected->flags[i]);
    FUZZ_CLAIM(fabs(told->volume[i] - volume) <= volume_allowed(x),
               "kernels of %s, place %d: V = %.17g; the model %.17g", name_of(m), i, told->volume[i], volume);
    const double allowed = width > 0 ? allowed_of(x, quantity, volume, b) : 0;
    for (int c = 0; c < width; c++)
      FUZZ_CLAIM(fabs(a[c] - b[c]) <= allowed,
                 "kernels of %s, quantity %d, place %d, number %d: %.17g; the model %.17g", name_of(m),
                 quantity, i, c, a[c], b[c]);
  }
}

static void check_places(int m, int quantity, const Batch *told) {
  const size_t width = (size_t)widths[quantity];
  FUZZ_CLAIM(memcmp(&told->volume[0], &told->volume[PLACES - 1], sizeof(double)) == 0 &&
                 told->flags[0] == told->flags[PLACES - 1] &&
                 memcmp(told->more, told->more + width * (PLACES - 1), width * sizeof(double)) == 0,
             "kernels of %s, quantity %d: V = %.17g in the first place, %.17g in the last", name_of(m),
             quantity, told->volume[0], told->volume[PLACES - 1]);
}

static void check_refused(const double *pairs) {
  static Batch told;
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++) {
    const OverlapBatch asked = batch_of(pairs, PLACES, DEVICE_GRADIENT, &told);
    const Status status = device_overlap_eval(&contestant_of(m)->kernels, &asked);
    FUZZ_CLAIM(status == STATUS_INPUT, "kernels of %s: status %d", name_of(m), (int)status);
  }
}

// Without vectors, or fused multiply-adds for networks, the processor's model is another.
static bool is_comparable(int m) {
  return is_clip(m) ? overlap_clip_lanes() != NULL : is_geo(m) || net_kernel_best() != NET_KERNEL_BLAS;
}

static void run(const uint8_t *data, size_t size) {
  static Batch told, expected;
  double pairs[PLACES * SIZE] = {0}, sum = 0;
  memcpy(pairs, data, size < PAIR_BYTES ? size : PAIR_BYTES);
  overlap_ops_swap(pairs, pairs + SIZE);
  memcpy(pairs + 2 * SIZE, pairs, PAIR_BYTES);
  for (int i = 0; i < SIZE; i++) sum += pairs[i] - pairs[i];
  if (sum != 0) {
    check_refused(pairs);
    return;
  }
  if (!fuzz_pairs_is_moderate(pairs)) return;
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++)
    for (int quantity = 0; quantity < QUANTITIES; quantity++) {
      if (!is_comparable(m) || !device_overlap_gives(name_of(m), (DeviceQuantity)quantity)) continue;
      ask_kernels(m, pairs, quantity, &told);
      ask_model(m, pairs, quantity, &expected);
      check_places(m, quantity, &told);
      if (is_geo(m))
        check_rounding(m, pairs, quantity, &told, &expected);
      else
        check_bits(m, pairs, quantity, &told, &expected);
    }
}

static size_t seed(int k, uint8_t *data) {
  return fuzz_pairs.seed(k, data);
}

static size_t mutate(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain) {
  return fuzz_pairs.mutate(data, size, room, number, plain);
}

const FuzzTarget fuzz_kernels = {.name = "kernels", .run = run, .seed = seed, .mutate = mutate};
