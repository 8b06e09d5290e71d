// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/foreign.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "overlap/clip/clip.h"
#include "overlap/foreign/library.h"
#include "overlap/foreign/process.h"
#include "overlap/foreign/request.h"
#include "overlap/separation.h"
#include "overlap/source.h"

typedef struct Foreign {
  OverlapOps ops;
  char name[128];
  OverlapForeignPort port;
  bool keeps_ghosts;
  pthread_mutex_t lock; // of all below, and of the port
  int *rows;            // of the batch: those that are asked for            (request.count)
  double *clipped;      // V by clipping [m³]                                (pair_count)
  size_t row_capacity, clipped_capacity;
  OverlapForeignRequest request;
} Foreign;

static const unsigned PAIRS = 1u << OVERLAP_FOREIGN_PAIRS, VOLUME = 1u << OVERLAP_FOREIGN_VOLUME,
                      GRADIENT = 1u << OVERLAP_FOREIGN_GRADIENT, CENTROID = 1u << OVERLAP_FOREIGN_CENTROID,
                      REST = 1u << OVERLAP_FOREIGN_REST, BY_VOLUME = 1u << OVERLAP_FOREIGN_BY_VOLUME,
                      BY_CENTROID = 1u << OVERLAP_FOREIGN_BY_CENTROID,
                      BY_GRADIENT = 1u << OVERLAP_FOREIGN_BY_GRADIENT, SLOPE = 1u << OVERLAP_FOREIGN_SLOPE;

static void destroy(void *self) {
  Foreign *foreign = self;
  if (foreign->port.close) foreign->port.close(foreign->port.self);
  memory_free(foreign->rows), memory_free(foreign->clipped);
  overlap_foreign_request_destroy(&foreign->request);
  pthread_mutex_destroy(&foreign->lock);
  memory_free(foreign);
}

static bool has_ghosts(const void *self) {
  return ((const Foreign *)self)->keeps_ghosts;
}

static bool has_centroid(const void *self) {
  return (((const Foreign *)self)->port.gives & TETLAP_MODEL_CENTROID) != 0;
}

static bool has_gradient(const void *self) {
  const OverlapForeignPort *port = &((const Foreign *)self)->port;
  return (port->gives & TETLAP_MODEL_GRADIENT) != 0 || port->pull;
}

static bool has_hessian(const void *self) {
  const OverlapForeignPort *port = &((const Foreign *)self)->port;
  return (port->gives & TETLAP_MODEL_CURVATURE) != 0 && port->pull;
}

static bool wants_origins(const void *self) {
  return (((const Foreign *)self)->port.gives & TETLAP_MODEL_ORIGINS) != 0;
}

static double determinant_of(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9)));
}

static double smaller_volume(const double pair[OVERLAP_PAIR_SIZE]) {
  const double a = determinant_of(pair), b = determinant_of(pair + 12);
  return (a < b ? a : b) / 6;
}

// Whether what is flat or disjoint is its own business.
static bool asks_for_all(const Foreign *foreign) {
  return (foreign->port.gives & TETLAP_MODEL_DISJOINT) != 0;
}

// What clipping finds so much of, as a share of the smaller tetrahedron, does overlap.
static const double CERTAIN_SHARE = 1e-6;

// Why a pair is not asked for: its flag; 0: it is asked for. `clipped`: V by clipping, NAN: not known. It
// only saves time: the separating axes of a pair that overlaps take ten times as long.
static unsigned answer_unasked(const Foreign *foreign, const double pair[OVERLAP_PAIR_SIZE], double clipped) {
  if (asks_for_all(foreign)) return 0;
  const double most = smaller_volume(pair);
  if (!(most > 0)) return OVERLAP_FLAT;
  if (foreign->keeps_ghosts || clipped > CERTAIN_SHARE * most) return 0;
  return overlap_separation_pair(pair, 0) >= 0 ? OVERLAP_DISJOINT : 0;
}

static Status reserve(Foreign *foreign, int count, unsigned wanted) {
  const size_t size = (size_t)count;
  if (!memory_reserve((void **)&foreign->rows, &foreign->row_capacity, size, sizeof(int)) ||
      !memory_reserve((void **)&foreign->clipped, &foreign->clipped_capacity, size, sizeof(double)))
    return status_no_memory("pairs for a model");
  return overlap_foreign_request_reserve(&foreign->request, size, wanted);
}

static void start(Foreign *foreign) {
  foreign->request.pairs = foreign->request.arrays[OVERLAP_FOREIGN_PAIRS];
  foreign->request.count = 0;
}

static void append(Foreign *foreign, int row, const double pair[OVERLAP_PAIR_SIZE]) {
  const size_t at = foreign->request.count++;
  foreign->rows[at] = row;
  memcpy(foreign->request.arrays[OVERLAP_FOREIGN_PAIRS] + OVERLAP_PAIR_SIZE * at, pair,
         OVERLAP_PAIR_SIZE * sizeof *pair);
}

// Without a copy: the coordinates are the batch's own.
static void take_all(Foreign *foreign, const OverlapBatch *batch) {
  foreign->request.pairs = batch->pairs;
  foreign->request.count = (size_t)batch->pair_count;
  for (int i = 0; i < batch->pair_count; i++) foreign->rows[i] = i;
}

static void choose(Foreign *foreign, const OverlapBatch *batch) {
  // Clipping refuses coordinates that the axes do not; then they decide alone.
  const bool is_clipped =
      !foreign->keeps_ghosts &&
      overlap_clip_ops.eval_batch(NULL, &(OverlapBatch){.pair_count = batch->pair_count,
                                                        .pairs = batch->pairs,
                                                        .volume = foreign->clipped}) == STATUS_OK;
  start(foreign);
  for (int i = 0; i < batch->pair_count; i++) {
    unsigned flags = 0;
    const double *pair = batch->pairs + (size_t)i * OVERLAP_PAIR_SIZE;
    OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
    *answer.flags = answer_unasked(foreign, pair, is_clipped ? foreign->clipped[i] : NAN);
    if (*answer.flags)
      overlap_ops_write_nothing(&answer);
    else
      append(foreign, i, pair);
  }
}

// Of the rows that are asked for: their numbers, `width` each.
static void gather(const Foreign *foreign, int width, const double *from, double *to) {
  for (size_t k = 0; k < foreign->request.count; k++)
    for (int c = 0; c < width; c++) *to++ = from[(size_t)width * (size_t)foreign->rows[k] + (size_t)c];
}

static void tell_origins(Foreign *foreign, const OverlapOrigins *origins) {
  OverlapForeignRequest *request = &foreign->request;
  gather(foreign, 2, origins->rest, request->arrays[OVERLAP_FOREIGN_REST]);
  for (size_t k = 0; k < 2 * request->count; k++) {
    const size_t at = 2 * (size_t)foreign->rows[k / 2] + k % 2;
    request->elements[k] = origins->elements[at], request->bodies[k] = origins->bodies[at];
  }
}

static bool are_finite(int count, const double *numbers) {
  double sum = 0; // x − x is 0 for finite x, else NaN
  for (int i = 0; i < count; i++) sum += numbers[i] - numbers[i];
  return sum == 0;
}

static Status fail_not_finite(const Foreign *foreign, int pair, const char *what) {
  return status_fail(STATUS_SOLVER, "overlap model '%s': pair %d: %s is not a finite number", foreign->name,
                     pair, what);
}

// The model's answer for one of the pairs asked for, into the batch.
static Status give(const Foreign *foreign, const OverlapBatch *batch, size_t at) {
  const int i = foreign->rows[at];
  unsigned flags = 0;
  OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
  double *const *arrays = foreign->request.arrays;
  const double volume = arrays[OVERLAP_FOREIGN_VOLUME][at];
  if (!isfinite(volume)) return fail_not_finite(foreign, i, "its volume");
  *answer.flags = volume < 0 ? OVERLAP_UNSOUND : 0;
  if (!(volume > 0)) {
    overlap_ops_write_nothing(&answer);
    return STATUS_OK;
  }
  if (volume > smaller_volume(batch->pairs + OVERLAP_PAIR_SIZE * (size_t)i) * (1 + 1e-9))
    *answer.flags = OVERLAP_UNSOUND;
  *answer.volume = volume;
  if (answer.gradient) {
    if (!are_finite(24, arrays[OVERLAP_FOREIGN_GRADIENT] + 24 * at))
      return fail_not_finite(foreign, i, "a gradient of it");
    memcpy(answer.gradient, arrays[OVERLAP_FOREIGN_GRADIENT] + 24 * at, 24 * sizeof(double));
  }
  if (answer.centroid) {
    if (!are_finite(3, arrays[OVERLAP_FOREIGN_CENTROID] + 3 * at))
      return fail_not_finite(foreign, i, "its centroid");
    memcpy(answer.centroid, arrays[OVERLAP_FOREIGN_CENTROID] + 3 * at, 3 * sizeof(double));
  }
  return STATUS_OK;
}

// ∇²V, row by row: the pull-back of one coordinate of ∇V.
static Status eval_hessian(Foreign *foreign, const OverlapBatch *batch) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  OverlapForeignRequest *request = &foreign->request;
  TRY(overlap_foreign_request_reserve(request, request->count, BY_VOLUME | BY_GRADIENT | SLOPE));
  double *by_volume = request->arrays[OVERLAP_FOREIGN_BY_VOLUME];
  double *by_gradient = request->arrays[OVERLAP_FOREIGN_BY_GRADIENT];
  for (size_t r = 0; r < SIZE; r++) {
    memset(by_volume, 0, request->count * sizeof *by_volume);
    memset(by_gradient, 0, SIZE * request->count * sizeof *by_gradient);
    for (size_t k = 0; k < request->count; k++) by_gradient[SIZE * k + r] = 1;
    TRY(overlap_foreign_request_pull(request, &foreign->port, foreign->name, BY_GRADIENT));
    for (size_t k = 0; k < request->count; k++) {
      const size_t i = (size_t)foreign->rows[k];
      const double *row = request->arrays[OVERLAP_FOREIGN_SLOPE] + SIZE * k;
      if (!are_finite(SIZE, row)) return fail_not_finite(foreign, (int)i, "a second derivative of it");
      if (batch->volume[i] > 0) memcpy(batch->hessian + SIZE * SIZE * i + SIZE * r, row, SIZE * sizeof *row);
    }
  }
  return STATUS_OK;
}

static Status eval(Foreign *foreign, const OverlapBatch *batch) {
  const bool tells = wants_origins(foreign) && batch->origins.elements;
  const unsigned wanted = PAIRS | VOLUME | (batch->gradient ? GRADIENT : 0) |
                          (batch->centroid ? CENTROID : 0) | (tells ? REST : 0);
  TRY(reserve(foreign, batch->pair_count, wanted));
  if (asks_for_all(foreign))
    take_all(foreign, batch);
  else
    choose(foreign, batch);
  if (foreign->request.count == 0) return STATUS_OK;
  if (tells) tell_origins(foreign, &batch->origins);
  TRY(overlap_foreign_request_ask(&foreign->request, &foreign->port, foreign->name, wanted));
  for (size_t k = 0; k < foreign->request.count; k++) TRY(give(foreign, batch, k));
  return batch->hessian ? eval_hessian(foreign, batch) : STATUS_OK;
}

static Status eval_batch(const void *self, const OverlapBatch *batch) {
  Foreign *foreign = (Foreign *)self; // its lock guards what changes
  pthread_mutex_lock(&foreign->lock);
  Status status = eval(foreign, batch);
  pthread_mutex_unlock(&foreign->lock);
  return status;
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch one = overlap_ops_single(pair, answer);
  return eval_batch(self, &one);
}

// V, where it is wanted, and one more array of all pairs as they stand.
static Status eval_all(Foreign *foreign, int count, const double *pairs, double *volumes,
                       OverlapForeignArray array, double *numbers) {
  OverlapForeignRequest *request = &foreign->request;
  const size_t bytes = (size_t)count * sizeof(double);
  const unsigned wanted = PAIRS | VOLUME | 1u << array;
  TRY(overlap_foreign_request_reserve(request, (size_t)count, wanted));
  memcpy(request->arrays[OVERLAP_FOREIGN_PAIRS], pairs, OVERLAP_PAIR_SIZE * bytes);
  start(foreign);
  request->count = (size_t)count;
  TRY(overlap_foreign_request_ask(request, &foreign->port, foreign->name, wanted));
  memcpy(numbers, request->arrays[array], bytes);
  if (volumes) memcpy(volumes, request->arrays[OVERLAP_FOREIGN_VOLUME], bytes);
  for (int i = 0; i < count; i++)
    if (!isfinite(numbers[i]))
      return fail_not_finite(foreign, i, array == OVERLAP_FOREIGN_LOGIT ? "its logit" : "its doubt");
  return STATUS_OK;
}

static Status eval_all_locked(const void *self, int count, const double *pairs, double *volumes,
                              OverlapForeignArray array, double *numbers) {
  Foreign *foreign = (Foreign *)self;
  if (count == 0) return STATUS_OK;
  pthread_mutex_lock(&foreign->lock);
  Status status = eval_all(foreign, count, pairs, volumes, array, numbers);
  pthread_mutex_unlock(&foreign->lock);
  return status;
}

static Status eval_logits(const void *self, int count, const double *pairs, double *logits) {
  return eval_all_locked(self, count, pairs, NULL, OVERLAP_FOREIGN_LOGIT, logits);
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  return eval_all_locked(self, count, pairs, volumes, OVERLAP_FOREIGN_DOUBT, bounds);
}

static Status pull(Foreign *foreign, const OverlapPull *asked) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  OverlapForeignRequest *request = &foreign->request;
  double **arrays = request->arrays;
  const unsigned wanted = PAIRS | BY_VOLUME | (asked->by_centroid ? BY_CENTROID : 0) |
                          (asked->by_gradient ? BY_GRADIENT : 0) | SLOPE;
  TRY(reserve(foreign, asked->pair_count, wanted));
  memset(asked->slope, 0, (size_t)asked->pair_count * SIZE * sizeof *asked->slope);
  start(foreign);
  for (int i = 0; i < asked->pair_count; i++) {
    const double *pair = asked->pairs + SIZE * (size_t)i;
    if (!answer_unasked(foreign, pair, NAN)) append(foreign, i, pair);
  }
  if (request->count == 0) return STATUS_OK;
  gather(foreign, 1, asked->by_volume, arrays[OVERLAP_FOREIGN_BY_VOLUME]);
  if (asked->by_centroid) gather(foreign, 3, asked->by_centroid, arrays[OVERLAP_FOREIGN_BY_CENTROID]);
  if (asked->by_gradient) gather(foreign, SIZE, asked->by_gradient, arrays[OVERLAP_FOREIGN_BY_GRADIENT]);
  TRY(overlap_foreign_request_pull(request, &foreign->port, foreign->name, wanted));
  for (size_t k = 0; k < request->count; k++) {
    const double *slope = arrays[OVERLAP_FOREIGN_SLOPE] + SIZE * k;
    if (!are_finite(SIZE, slope)) return fail_not_finite(foreign, foreign->rows[k], "its pull-back");
    memcpy(asked->slope + SIZE * (size_t)foreign->rows[k], slope, SIZE * sizeof *slope);
  }
  return STATUS_OK;
}

static Status eval_pull(const void *self, const OverlapPull *asked) {
  Foreign *foreign = (Foreign *)self;
  pthread_mutex_lock(&foreign->lock);
  Status status = pull(foreign, asked);
  pthread_mutex_unlock(&foreign->lock);
  return status;
}

static const OverlapOps standard = {
    .help = "a model of yours",
    .seconds_per_pair = 1e-5,
    .eval_pair = eval_pair,
    .eval_batch = eval_batch,
    .destroy = destroy,
    .has_ghosts = has_ghosts,
    .rejects_disjoint = true,
    .has_centroid = has_centroid,
    .has_gradient = has_gradient,
    .has_hessian = has_hessian,
    .wants_origins = wants_origins,
};

static Status open_port(OverlapForeignPort *port, const char *word) {
  static const char COMMAND[] = "exec:";
  switch (overlap_source_of(word)) {
  case OVERLAP_SOURCE_LIBRARY:
    return overlap_foreign_library_open(port, word);
  case OVERLAP_SOURCE_PYTHON:
    return overlap_foreign_process_open_python(port, word);
  case OVERLAP_SOURCE_CHANNEL:
    return overlap_foreign_process_attach(port, word);
  case OVERLAP_SOURCE_COMMAND:
    return overlap_foreign_process_open(port, word + sizeof COMMAND - 1);
  case OVERLAP_SOURCE_NAME:
  case OVERLAP_SOURCE_WEIGHTS:
    break;
  }
  return status_fail(STATUS_INPUT, "%s: names no model of yours", word);
}

Status overlap_foreign_create(void **self, const OverlapOps **ops, const char *word,
                              const OverlapOptions *options) {
  if (options && options->ghosts == OVERLAP_GHOSTS_FADE)
    return status_fail(STATUS_INPUT, "%s: ghosts: fade is for networks of tetlap; write `cut` or `keep`",
                       word);
  Foreign *foreign = memory_zeroed(1, sizeof *foreign);
  if (!foreign) return status_no_memory("a model of yours");
  pthread_mutex_init(&foreign->lock, NULL);
  snprintf(foreign->name, sizeof foreign->name, "%s", word);
  foreign->keeps_ghosts = options && options->ghosts == OVERLAP_GHOSTS_KEEP;
  foreign->ops = standard;
  foreign->ops.name = foreign->name;
  Status status = open_port(&foreign->port, word);
  if (status) {
    destroy(foreign);
    return status;
  }
  if (foreign->port.gives & TETLAP_MODEL_LOGIT) foreign->ops.eval_logits = eval_logits;
  if (foreign->port.gives & TETLAP_MODEL_DOUBT) foreign->ops.eval_bounds = eval_bounds;
  if (foreign->port.pull) foreign->ops.eval_pull = eval_pull;
  *self = foreign, *ops = &foreign->ops;
  return STATUS_OK;
}

Status overlap_foreign_hand_on(const char *word) {
  return overlap_foreign_process_hand_on(word);
}
