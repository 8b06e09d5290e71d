// SPDX-License-Identifier: Apache-2.0
#include "device/overlap/overlap.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "device/overlap/geo.h"
#include "device/overlap/stage.h"
#include "device/overlap/tpn.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"

enum { SIZE = OVERLAP_PAIR_SIZE, GATHER = 0, SCATTER = 1 };

typedef struct DeviceOverlapChain {
  const char *model;
  const DeviceProgram *programs[DEVICE_OVERLAP_STAGES];
  unsigned flags;      // of what the host answers, besides its own
  const char *weights; // of a TetrahedronPairNet; NULL: there is none
  bool is_bf16;        // whose factors are rounded
  int feature_count;   // of a network of geo; 0: there is none
  bool has_centroid;
  double flops[3], instructions[3]; // of clipping, of DeviceQuantity: tests/device/count_operations.cpp
} DeviceOverlapChain;

#define CLIP_FLOPS                                                                                           \
  { 1557, 2138, 2114 }
#define CLIP_INSTRUCTIONS                                                                                    \
  { 1153, 1582, 1549 }

static const DeviceOverlapChain chains[DEVICE_OVERLAP_MODELS] = {
    {.model = "clip",
     .programs = {&device_program_clip, &device_program_scalar},
     .has_centroid = true,
     .flops = CLIP_FLOPS,
     .instructions = CLIP_INSTRUCTIONS},
    {.model = "clip32",
     .programs = {&device_program_clip32, &device_program_clip, &device_program_scalar},
     .has_centroid = true,
     .flops = CLIP_FLOPS,
     .instructions = CLIP_INSTRUCTIONS},
    {.model = "tpn", .programs = {&device_program_tpn}, .flags = OVERLAP_FALLBACK, .weights = "tpn"},
    {.model = "tpn-published",
     .programs = {&device_program_tpn},
     .flags = OVERLAP_FALLBACK,
     .weights = "tpn-published"},
    {.model = "tpn-bf16",
     .programs = {&device_program_tpn_bf16},
     .flags = OVERLAP_FALLBACK,
     .weights = "tpn",
     .is_bf16 = true},
    {.model = "geo-small",
     .programs = {&device_program_geo_small, &device_program_clip, &device_program_scalar},
     .feature_count = 56,
     .has_centroid = true},
    {.model = "geo",
     .programs = {&device_program_geo, &device_program_clip, &device_program_scalar},
     .feature_count = 120,
     .has_centroid = true},
};
const char *const device_overlap_models[DEVICE_OVERLAP_MODELS] = {
    "clip", "clip32", "tpn", "tpn-published", "tpn-bf16", "geo-small", "geo"};

static const DeviceOverlapChain *find_chain(const char *model) {
  for (int k = 0; k < DEVICE_OVERLAP_MODELS; k++)
    if (strcmp(chains[k].model, model) == 0) return &chains[k];
  return NULL;
}

bool device_overlap_gives(const char *model, DeviceQuantity quantity) {
  const DeviceOverlapChain *chain = find_chain(model);
  return chain && (quantity != DEVICE_CENTROID || chain->has_centroid);
}

double device_overlap_flops(const DeviceOverlap *overlap, DeviceQuantity quantity) {
  const double forward = overlap->tpn.flops + overlap->geo.flops; // there is one at most
  return overlap->chain->flops[quantity] + (quantity == DEVICE_GRADIENT ? 2 * forward : forward);
}

double device_overlap_instructions(const DeviceOverlap *overlap, DeviceQuantity quantity) {
  const DeviceOverlapChain *chain = overlap->chain;
  const bool is_clip = chain->flops[quantity] > 0;
  // products of networks are fused multiply-adds
  return is_clip          ? chain->instructions[quantity]
         : chain->is_bf16 ? 0
                          : 0.5 * device_overlap_flops(overlap, quantity);
}

DeviceArithmetic device_overlap_arithmetic(const DeviceOverlap *overlap) {
  const DeviceOverlapChain *chain = overlap->chain;
  const bool is_single = chain->weights || chain->programs[0] == &device_program_clip32;
  return chain->is_bf16 ? DEVICE_IN_BF16 : is_single ? DEVICE_IN_FLOAT : DEVICE_IN_DOUBLE;
}

const char *device_overlap_weights(const DeviceOverlap *overlap) {
  return overlap->chain->feature_count > 0 ? overlap->chain->model : overlap->chain->weights;
}

static Status create(DeviceOverlap *overlap, const DeviceOverlapChain *chain) {
  const Device *device = overlap->device;
  for (int k = 0; k < DEVICE_OVERLAP_STAGES && chain->programs[k]; k++, overlap->stage_count++)
    TRY(device_build(device, chain->programs[k], &overlap->stages[k].module, overlap->stages[k].kernels));
  overlap->host = (OverlapModel){.ops = chain->weights ? &overlap_exact_ops : &overlap_clip_scalar_ops};
  if (chain->weights) TRY(device_tpn_create(&overlap->tpn, device, chain->weights, chain->is_bf16));
  if (chain->feature_count > 0) {
    TRY(device_geo_create(&overlap->geo, device, chain->model, chain->feature_count));
    overlap->host = overlap->geo.host;
  }
  TRY(device_build(device, &device_program_gather, &overlap->gather.module, overlap->gather.kernels));
  return device_take(device, 1, sizeof(int), NULL, &overlap->list_count);
}

Status device_overlap_create(DeviceOverlap *overlap, const Device *device, const char *model) {
  *overlap = (DeviceOverlap){.device = device};
  const DeviceOverlapChain *chain = overlap->chain = find_chain(model);
  if (!chain)
    return status_fail(STATUS_USAGE,
                       "overlap model '%s' has no kernels for devices; clip, clip32, tpn, tpn-published, "
                       "tpn-bf16, geo-small and geo have",
                       model);
  return create(overlap, chain);
}

static void release(const DeviceOverlap *overlap, DeviceMemory *memory) {
  overlap->device->ops->release(overlap->device->self, memory);
}

static void release_rows(DeviceOverlap *overlap) {
  release(overlap, &overlap->rows), release(overlap, &overlap->row_volume);
  release(overlap, &overlap->row_more), release(overlap, &overlap->row_flags);
  overlap->row_capacity = 0;
}

static void release_answers(DeviceOverlap *overlap) {
  release(overlap, &overlap->volume), release(overlap, &overlap->more);
  release(overlap, &overlap->flags), release(overlap, &overlap->lists[0]);
  release(overlap, &overlap->lists[1]);
  overlap->capacity = 0;
}

static void release_inputs(DeviceOverlap *overlap) {
  release(overlap, &overlap->numbers), release(overlap, &overlap->tets), release(overlap, &overlap->pairs);
}

void device_overlap_destroy(DeviceOverlap *overlap) {
  if (!overlap->device) return;
  const Device *device = overlap->device;
  release_rows(overlap), release_answers(overlap), release_inputs(overlap);
  release(overlap, &overlap->list_count);
  device_tpn_destroy(&overlap->tpn, device);
  device_geo_destroy(&overlap->geo, device);
  for (int k = 0; k < DEVICE_OVERLAP_STAGES; k++)
    device->ops->discard(device->self, overlap->stages[k].module);
  device->ops->discard(device->self, overlap->gather.module);
  *overlap = (DeviceOverlap){0};
}

// Room for the answers to `count` pairs.
static Status make_room(DeviceOverlap *overlap, int count) {
  const Device *device = overlap->device;
  if (count <= overlap->capacity) return STATUS_OK;
  release_answers(overlap);
  size_t n = (size_t)count;
  TRY(device_take(device, n, sizeof(double), NULL, &overlap->volume));
  TRY(device_take(device, n, 1, NULL, &overlap->flags));
  for (int k = 0; k < 2; k++) TRY(device_take(device, n, sizeof(int), NULL, &overlap->lists[k]));
  overlap->capacity = count;
  return STATUS_OK;
}

static Status put_numbers(DeviceOverlap *overlap, DevicePairs kind, int count, const double *pairs) {
  const Device *device = overlap->device;
  size_t bytes = (size_t)count * SIZE * sizeof *pairs;
  overlap->kind = kind, overlap->count = 0;
  if (overlap->numbers.bytes < bytes || overlap->pairs.at) {
    release_inputs(overlap);
    TRY(device_take(device, (size_t)count * SIZE, sizeof *pairs, NULL, &overlap->numbers));
  }
  TRY(make_room(overlap, count));
  TRY(device->ops->put(device->self, &overlap->numbers, 0, bytes, pairs));
  overlap->count = count;
  return STATUS_OK;
}

Status device_overlap_put_columns(DeviceOverlap *overlap, int count, const double *pairs) {
  return put_numbers(overlap, DEVICE_PAIRS_COLUMNS, count, pairs);
}

Status device_overlap_put_mesh(DeviceOverlap *overlap, int vertex_count, const double *positions,
                               int tet_count, const int *tets, int count, const int *pairs) {
  const Device *device = overlap->device;
  overlap->kind = DEVICE_PAIRS_INDICES, overlap->count = 0;
  release_inputs(overlap);
  TRY(device_take(device, 3 * (size_t)vertex_count, sizeof *positions, positions, &overlap->numbers));
  TRY(device_take(device, 4 * (size_t)tet_count, sizeof *tets, tets, &overlap->tets));
  TRY(device_take(device, 2 * (size_t)count, sizeof *pairs, pairs, &overlap->pairs));
  TRY(make_room(overlap, count));
  overlap->count = count;
  return STATUS_OK;
}

// --- What is left to the host.

typedef struct Rows {
  int count;
  int *numbers;           // of the pairs                    (count)
  double *pairs, *volume; // (count, 24), (count)
  double *more;           // ∇V (count, 24) or x̄ (count, 3)
  unsigned char *flags;   // (count)
} Rows;

static void destroy_rows(Rows *rows) {
  memory_free(rows->numbers), memory_free(rows->pairs), memory_free(rows->volume);
  memory_free(rows->more), memory_free(rows->flags);
}

static Status create_rows(Rows *rows, int count) {
  size_t n = (size_t)count;
  *rows = (Rows){.count = count,
                 .numbers = memory_zeroed(n, sizeof(int)),
                 .pairs = memory_zeroed(n * SIZE, sizeof(double)),
                 .volume = memory_zeroed(n, sizeof(double)),
                 .more = memory_zeroed(n * SIZE, sizeof(double)),
                 .flags = memory_zeroed(n, 1)};
  if (rows->numbers && rows->pairs && rows->volume && rows->more && rows->flags) return STATUS_OK;
  destroy_rows(rows);
  return status_no_memory("pairs that the device leaves to the host");
}

static Status make_rows_room(DeviceOverlap *overlap, int count) {
  const Device *device = overlap->device;
  if (count <= overlap->row_capacity) return STATUS_OK;
  release_rows(overlap);
  size_t n = (size_t)count;
  TRY(device_take(device, n * SIZE, sizeof(double), NULL, &overlap->rows));
  TRY(device_take(device, n, sizeof(double), NULL, &overlap->row_volume));
  TRY(device_take(device, n * SIZE, sizeof(double), NULL, &overlap->row_more));
  TRY(device_take(device, n, 1, NULL, &overlap->row_flags));
  overlap->row_capacity = count;
  return STATUS_OK;
}

static Status fetch_rows(DeviceOverlap *overlap, const DeviceMemory *list, Rows *rows) {
  const Device *device = overlap->device;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, rows->count, list, arguments);
  arguments[n++] = device_memory(&overlap->rows);
  TRY(device_launch(device, &overlap->gather.kernels[GATHER], rows->count, arguments, n));
  TRY(device->ops->get(device->self, list, 0, (size_t)rows->count * sizeof(int), rows->numbers));
  return device->ops->get(device->self, &overlap->rows, 0, (size_t)rows->count * SIZE * sizeof(double),
                          rows->pairs);
}

static Status answer_row(const DeviceOverlap *overlap, Rows *rows, int i, DeviceQuantity quantity) {
  const double *pair = rows->pairs + (size_t)i * SIZE;
  for (int c = 0; c < SIZE; c++)
    if (!isfinite(pair[c]))
      return status_fail(
          STATUS_INPUT, "pair %d, tetrahedron %d, vertex %d: coordinate %c is %g, it must be a finite number",
          rows->numbers[i], c / 12, c / 3 % 4, "xyz"[c % 3], pair[c]);
  unsigned flags = 0;
  const OverlapAnswer answer = {.volume = rows->volume + i,
                                .gradient =
                                    quantity == DEVICE_GRADIENT ? rows->more + (size_t)i * SIZE : NULL,
                                .centroid = quantity == DEVICE_CENTROID ? rows->more + (size_t)i * 3 : NULL,
                                .flags = &flags};
  TRY(overlap->host.ops->eval_pair(overlap->host.self, pair, &answer));
  rows->flags[i] = (unsigned char)(flags | overlap->chain->flags);
  return STATUS_OK;
}

static Status answer_rows(const DeviceOverlap *overlap, Rows *rows, DeviceQuantity quantity) {
  int first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic, 16) reduction(min : first_failed) if (rows->count > 64)
  for (int i = 0; i < rows->count; i++)
    if (answer_row(overlap, rows, i, quantity) != STATUS_OK && i < first_failed) first_failed = i;
  // the message belongs to the thread that failed: let this one see it too
  return first_failed == INT_MAX ? STATUS_OK : answer_row(overlap, rows, first_failed, quantity);
}

static Status send_rows(DeviceOverlap *overlap, const DeviceMemory *list, const Rows *rows,
                        DeviceQuantity quantity) {
  const Device *device = overlap->device;
  size_t n = (size_t)rows->count;
  TRY(device->ops->put(device->self, &overlap->row_volume, 0, n * sizeof(double), rows->volume));
  TRY(device->ops->put(device->self, &overlap->row_flags, 0, n, rows->flags));
  const int width = quantity == DEVICE_GRADIENT ? SIZE : quantity == DEVICE_CENTROID ? 3 : 0;
  if (width > 0)
    TRY(device->ops->put(device->self, &overlap->row_more, 0, n * (size_t)width * sizeof(double),
                         rows->more));
  const DeviceArgument arguments[] = {device_int((int)overlap->kind),
                                      device_int(rows->count),
                                      device_int(overlap->count),
                                      device_memory(list),
                                      device_memory(&overlap->row_volume),
                                      device_memory(&overlap->row_flags),
                                      device_int(width),
                                      device_memory(&overlap->row_more),
                                      device_memory(&overlap->volume),
                                      device_memory(&overlap->flags),
                                      device_memory(&overlap->more)};
  return device_launch(device, &overlap->gather.kernels[SCATTER], rows->count, arguments,
                       sizeof arguments / sizeof *arguments);
}

static Status answer_on_host(DeviceOverlap *overlap, const DeviceMemory *list, int count,
                             DeviceQuantity quantity) {
  Rows rows;
  TRY(make_rows_room(overlap, count));
  TRY(create_rows(&rows, count));
  Status status = fetch_rows(overlap, list, &rows);
  if (status == STATUS_OK) status = answer_rows(overlap, &rows, quantity);
  if (status == STATUS_OK) status = send_rows(overlap, list, &rows, quantity);
  destroy_rows(&rows);
  return status;
}

// Each stage takes what the one before leaves; what is left in the end, in lists[*list].
static Status run_stages(DeviceOverlap *overlap, DeviceQuantity quantity, int *left, int *list) {
  *left = overlap->count;
  overlap->flop_pairs = overlap->count;
  for (int k = 0; k<overlap->stage_count && * left> 0; k++) {
    const DeviceOverlapAnswers answers = {&overlap->volume, &overlap->flags, &overlap->more,
                                          &overlap->lists[k % 2], &overlap->list_count};
    TRY(device_overlap_stage(overlap, k, *left, k > 0 ? &overlap->lists[(k + 1) % 2] : NULL, quantity,
                             &answers, left));
    overlap->handed_on[k] = *left;
    *list = k % 2;
  }
  return STATUS_OK;
}

Status device_overlap_run(DeviceOverlap *overlap, DeviceQuantity quantity) {
  const Device *device = overlap->device;
  const size_t room = (size_t)overlap->capacity * SIZE;
  if (!device_overlap_gives(overlap->chain->model, quantity))
    return status_fail(STATUS_USAGE, "overlap model '%s' gives no centroid", overlap->chain->model);
  if (quantity != DEVICE_VOLUME && overlap->more.bytes < room * sizeof(double)) {
    release(overlap, &overlap->more);
    TRY(device_take(device, room, sizeof(double), NULL, &overlap->more));
  }
  overlap->last = quantity;
  overlap->kernel_s = overlap->gate_s = 0;
  overlap->flop_pairs = 0;
  memset(overlap->handed_on, 0, sizeof overlap->handed_on);
  int left = 0, list = 0;
  TRY(overlap->chain->feature_count > 0 ? device_overlap_geo_run(overlap, quantity, &left)
      : overlap->chain->weights         ? device_overlap_tpn_run(overlap, quantity, &left)
                                        : run_stages(overlap, quantity, &left, &list));
  return left == 0 ? STATUS_OK : answer_on_host(overlap, &overlap->lists[list], left, quantity);
}

static Status get_flags(const DeviceOverlap *overlap, unsigned *flags) {
  const Device *device = overlap->device;
  size_t n = (size_t)overlap->count;
  unsigned char *bytes = memory_zeroed(n, 1);
  if (!bytes) return status_no_memory("flags");
  Status status = device->ops->get(device->self, &overlap->flags, 0, n, bytes);
  for (size_t i = 0; i < n; i++) flags[i] = bytes[i];
  memory_free(bytes);
  return status;
}

Status device_overlap_get(DeviceOverlap *overlap, double *volume, double *more, unsigned *flags) {
  const Device *device = overlap->device;
  size_t n = (size_t)overlap->count;
  TRY(device->ops->get(device->self, &overlap->volume, 0, n * sizeof *volume, volume));
  const size_t width = overlap->last == DEVICE_CENTROID ? 3 : SIZE;
  if (more) TRY(device->ops->get(device->self, &overlap->more, 0, n * width * sizeof *more, more));
  return flags ? get_flags(overlap, flags) : STATUS_OK;
}

Status device_overlap_eval(DeviceOverlap *overlap, const OverlapBatch *batch) {
  if (batch->hessian || (batch->gradient && batch->centroid))
    return status_fail(STATUS_INPUT, "a device gives V, and its gradient or the centroid, but no Hessian");
  const DeviceQuantity quantity = batch->gradient   ? DEVICE_GRADIENT
                                  : batch->centroid ? DEVICE_CENTROID
                                                    : DEVICE_VOLUME;
  TRY(put_numbers(overlap, DEVICE_PAIRS_ROWS, batch->pair_count, batch->pairs));
  TRY(device_overlap_run(overlap, quantity));
  return device_overlap_get(overlap, batch->volume, batch->gradient ? batch->gradient : batch->centroid,
                            batch->flags);
}
