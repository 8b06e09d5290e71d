// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/foreign.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/foreign/library.h"
#include "overlap/foreign/process.h"
#include "overlap/foreign/request.h"
#include "overlap/pair/range.h"
#include "overlap/pair/sizes.h"
#include "overlap/source.h"

typedef struct Foreign {
  OverlapOps ops;
  char name[128];
  OverlapUnsound unsound;
  OverlapForeignPort port;
  OverlapRange range;   // where `ops` says so
  pthread_mutex_t lock; // of the request, and of the port
  OverlapForeignRequest request;
} Foreign;

static const unsigned PAIRS = 1u << OVERLAP_FOREIGN_PAIRS, VOLUME = 1u << OVERLAP_FOREIGN_VOLUME,
                      GRADIENT = 1u << OVERLAP_FOREIGN_GRADIENT, CENTROID = 1u << OVERLAP_FOREIGN_CENTROID,
                      REST = 1u << OVERLAP_FOREIGN_REST, BY_VOLUME = 1u << OVERLAP_FOREIGN_BY_VOLUME,
                      BY_CENTROID = 1u << OVERLAP_FOREIGN_BY_CENTROID, DOUBT = 1u << OVERLAP_FOREIGN_DOUBT,
                      DOUBT_GRADIENT = 1u << OVERLAP_FOREIGN_DOUBT_GRADIENT,
                      BY_GRADIENT = 1u << OVERLAP_FOREIGN_BY_GRADIENT, SLOPE = 1u << OVERLAP_FOREIGN_SLOPE;

static void destroy(void *self) {
  Foreign *foreign = self;
  if (foreign->port.close) foreign->port.close(foreign->port.self);
  overlap_foreign_request_destroy(&foreign->request);
  pthread_mutex_destroy(&foreign->lock);
  memory_free(foreign);
}

// Whether what is flat or disjoint is its own business.
static bool asks_for_all(const Foreign *foreign) {
  return (foreign->port.gives & TETLAP_MODEL_DISJOINT) != 0;
}

static bool has_ghosts(const void *self) {
  return !asks_for_all(self);
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

// Copies, but for a model that is asked for all: the caller's own.
static void take(Foreign *foreign, int count, const double *pairs) {
  double *copies = foreign->request.arrays[OVERLAP_FOREIGN_PAIRS];
  foreign->request.count = (size_t)count;
  foreign->request.pairs = asks_for_all(foreign) ? pairs : copies;
  if (!asks_for_all(foreign))
    memcpy(copies, pairs, OVERLAP_PAIR_SIZE * foreign->request.count * sizeof *pairs);
}

static void tell_origins(Foreign *foreign, const OverlapOrigins *origins) {
  OverlapForeignRequest *request = &foreign->request;
  const size_t count = 2 * request->count;
  memcpy(request->arrays[OVERLAP_FOREIGN_REST], origins->rest, count * sizeof *origins->rest);
  memcpy(request->elements, origins->elements, count * sizeof *origins->elements);
  memcpy(request->bodies, origins->bodies, count * sizeof *origins->bodies);
}

static Status fail_not_finite(const Foreign *foreign, int pair, const char *what) {
  return status_fail(STATUS_SOLVER, "overlap model '%s': pair %d: %s is not a finite number", foreign->name,
                     pair, what);
}

// Infinite: it knows nothing of the pair.
static Status check_doubt(const Foreign *foreign, double doubt, int i) {
  return doubt >= 0
             ? STATUS_OK
             : status_fail(STATUS_SOLVER, "overlap model '%s': pair %d: its doubt is %g, expected 0 or more",
                           foreign->name, i, doubt);
}

// The doubt of a pair, with its gradient.
static Status give_doubt(const Foreign *foreign, const OverlapBatch *batch, size_t at, int number) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  const double doubt = foreign->request.arrays[OVERLAP_FOREIGN_DOUBT][at];
  batch->doubt[at] = doubt;
  TRY(check_doubt(foreign, doubt, number));
  if (!batch->doubt_gradient) return STATUS_OK;
  double *gradient = batch->doubt_gradient + SIZE * at;
  memset(gradient, 0, SIZE * sizeof *gradient);
  if (!isfinite(doubt)) return STATUS_OK;
  memcpy(gradient, foreign->request.arrays[OVERLAP_FOREIGN_DOUBT_GRADIENT] + SIZE * at,
         SIZE * sizeof *gradient);
  return overlap_ops_are_finite(SIZE, gradient)
             ? STATUS_OK
             : fail_not_finite(foreign, number, "the gradient of its doubt");
}

// Whether the pair is within the range that the model declares.
static bool is_within(const Foreign *foreign, const double *pair, double volume) {
  const OverlapRange *range = foreign->ops.range;
  return !range || (overlap_range_weight(range, pair, NULL, NULL) >= 1 && volume <= range->overlap);
}

static int number_of(const OverlapBatch *batch, size_t at) {
  return batch->numbers ? batch->numbers[at] : (int)at;
}

// What of its answer is no finite number, of what counts; NULL: nothing.
static const char *find_not_finite(const Foreign *foreign, const OverlapBatch *batch, size_t at) {
  double *const *arrays = foreign->request.arrays;
  const double volume = arrays[OVERLAP_FOREIGN_VOLUME][at];
  if (!isfinite(volume)) return "its volume";
  if (!(volume > 0)) return NULL;
  if (batch->gradient && !overlap_ops_are_finite(24, arrays[OVERLAP_FOREIGN_GRADIENT] + 24 * at))
    return "a gradient of it";
  return batch->centroid && !overlap_ops_are_finite(3, arrays[OVERLAP_FOREIGN_CENTROID] + 3 * at)
             ? "its centroid"
             : NULL;
}

// A pair whose answer has something that is not finite.
static Status give_not_finite(const Foreign *foreign, const OverlapBatch *batch, size_t at,
                              const char *what) {
  unsigned flags;
  OverlapAnswer answer = overlap_ops_answer(batch, (int)at, &flags);
  if (foreign->unsound != OVERLAP_UNSOUND_COUNT) return fail_not_finite(foreign, number_of(batch, at), what);
  overlap_ops_write_nothing(&answer);
  *answer.flags = OVERLAP_UNSOUND;
  if (batch->doubt) batch->doubt[at] = INFINITY;
  if (batch->doubt_gradient) memset(batch->doubt_gradient + 24 * at, 0, 24 * sizeof *batch->doubt_gradient);
  return STATUS_OK;
}

static Status give_unsound(const Foreign *foreign, double volume, double smaller, int i, unsigned *flags) {
  if (foreign->unsound == OVERLAP_UNSOUND_FATAL)
    return overlap_ops_fail_impossible(foreign->name, i, volume, smaller);
  *flags |= OVERLAP_UNSOUND;
  return STATUS_OK;
}

// The model's answer for one pair, into the batch.
static Status give(const Foreign *foreign, const OverlapBatch *batch, size_t at) {
  unsigned flags = 0;
  OverlapAnswer answer = overlap_ops_answer(batch, (int)at, &flags);
  double *const *arrays = foreign->request.arrays;
  const char *wrong = find_not_finite(foreign, batch, at);
  if (wrong) return give_not_finite(foreign, batch, at, wrong);
  if (batch->doubt) TRY(give_doubt(foreign, batch, at, number_of(batch, at)));
  const double volume = arrays[OVERLAP_FOREIGN_VOLUME][at];
  const double smaller = overlap_sizes_smaller(batch->pairs + OVERLAP_PAIR_SIZE * at);
  *answer.flags = 0;
  if (volume == 0 && asks_for_all(foreign)) *answer.flags = smaller > 0 ? OVERLAP_DISJOINT : OVERLAP_FLAT;
  if (!(*answer.flags) && !is_within(foreign, batch->pairs + OVERLAP_PAIR_SIZE * at, volume))
    *answer.flags = OVERLAP_BEYOND;
  if (!overlap_ops_is_possible(volume, smaller))
    TRY(give_unsound(foreign, volume, smaller, number_of(batch, at), answer.flags));
  if (!(volume > 0)) {
    overlap_ops_write_nothing(&answer);
    return STATUS_OK;
  }
  *answer.volume = volume;
  if (answer.gradient)
    memcpy(answer.gradient, arrays[OVERLAP_FOREIGN_GRADIENT] + 24 * at, 24 * sizeof(double));
  if (answer.centroid) memcpy(answer.centroid, arrays[OVERLAP_FOREIGN_CENTROID] + 3 * at, 3 * sizeof(double));
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
      const double *row = request->arrays[OVERLAP_FOREIGN_SLOPE] + SIZE * k;
      if (!(batch->volume[k] > 0)) continue;
      if (overlap_ops_are_finite(SIZE, row))
        memcpy(batch->hessian + SIZE * SIZE * k + SIZE * r, row, SIZE * sizeof *row);
      else
        TRY(give_not_finite(foreign, batch, k, "a second derivative of it"));
    }
  }
  return STATUS_OK;
}

static Status eval(Foreign *foreign, const OverlapBatch *batch) {
  const bool tells = wants_origins(foreign) && batch->origins.elements;
  const unsigned wanted = PAIRS | VOLUME | (batch->gradient ? GRADIENT : 0) |
                          (batch->centroid ? CENTROID : 0) | (batch->doubt ? DOUBT : 0) |
                          (batch->doubt_gradient ? DOUBT_GRADIENT : 0) | (tells ? REST : 0);
  if (batch->pair_count == 0) return STATUS_OK;
  TRY(overlap_foreign_request_reserve(&foreign->request, (size_t)batch->pair_count, wanted));
  take(foreign, batch->pair_count, batch->pairs);
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
  take(foreign, count, pairs);
  TRY(overlap_foreign_request_ask(request, &foreign->port, foreign->name, wanted));
  memcpy(numbers, request->arrays[array], bytes);
  if (volumes) memcpy(volumes, request->arrays[OVERLAP_FOREIGN_VOLUME], bytes);
  for (int i = 0; i < count; i++)
    if (array == OVERLAP_FOREIGN_LOGIT && !isfinite(numbers[i]))
      return fail_not_finite(foreign, i, "its logit");
    else if (array == OVERLAP_FOREIGN_DOUBT)
      TRY(check_doubt(foreign, numbers[i], i));
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
  const size_t count = (size_t)asked->pair_count, bytes = count * sizeof *asked->slope;
  const unsigned wanted = PAIRS | BY_VOLUME | (asked->by_centroid ? BY_CENTROID : 0) |
                          (asked->by_gradient ? BY_GRADIENT : 0) | SLOPE;
  if (count == 0) return STATUS_OK;
  TRY(overlap_foreign_request_reserve(request, count, wanted));
  take(foreign, asked->pair_count, asked->pairs);
  memcpy(arrays[OVERLAP_FOREIGN_BY_VOLUME], asked->by_volume, bytes);
  if (asked->by_centroid) memcpy(arrays[OVERLAP_FOREIGN_BY_CENTROID], asked->by_centroid, 3 * bytes);
  if (asked->by_gradient) memcpy(arrays[OVERLAP_FOREIGN_BY_GRADIENT], asked->by_gradient, SIZE * bytes);
  TRY(overlap_foreign_request_pull(request, &foreign->port, foreign->name, wanted));
  for (size_t k = 0; k < count; k++)
    if (!overlap_ops_are_finite(SIZE, arrays[OVERLAP_FOREIGN_SLOPE] + SIZE * k))
      return fail_not_finite(foreign, asked->numbers ? asked->numbers[k] : (int)k, "its pull-back");
  memcpy(asked->slope, arrays[OVERLAP_FOREIGN_SLOPE], SIZE * bytes);
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

static Status read_range(Foreign *foreign) {
  const char *text = foreign->port.range;
  if (!text) return STATUS_OK;
  if (!overlap_range_parse(text, &foreign->range))
    return status_fail(
        STATUS_INPUT,
        "%s: its range is '%.200s', expected 'radius A to B, first volume A to B, second volume A "
        "to B, overlap to B' with 0 <= A <= B, 0 < B",
        foreign->name, text);
  foreign->ops.range = &foreign->range;
  return STATUS_OK;
}

Status overlap_foreign_create(void **self, const OverlapOps **ops, const char *word, OverlapUnsound unsound) {
  Foreign *foreign = memory_zeroed(1, sizeof *foreign);
  if (!foreign) return status_no_memory("a model of yours");
  pthread_mutex_init(&foreign->lock, NULL);
  snprintf(foreign->name, sizeof foreign->name, "%s", word);
  foreign->unsound = unsound;
  foreign->ops = standard;
  foreign->ops.name = foreign->name;
  Status status = open_port(&foreign->port, word);
  if (!status) status = read_range(foreign);
  if (status) {
    destroy(foreign);
    return status;
  }
  if (foreign->port.gives & TETLAP_MODEL_LOGIT) foreign->ops.eval_logits = eval_logits;
  foreign->ops.gives_doubt = (foreign->port.gives & TETLAP_MODEL_DOUBT) != 0;
  foreign->ops.gives_doubt_gradient =
      foreign->ops.gives_doubt && (foreign->port.gives & TETLAP_MODEL_DOUBT_GRADIENT);
  if (foreign->ops.gives_doubt) foreign->ops.eval_bounds = eval_bounds;
  if (foreign->port.pull) foreign->ops.eval_pull = eval_pull;
  *self = foreign, *ops = &foreign->ops;
  return STATUS_OK;
}

Status overlap_foreign_hand_on(const char *word) {
  return overlap_foreign_process_hand_on(overlap_source_model(word));
}
