// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/foreign.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "overlap/foreign/library.h"
#include "overlap/foreign/process.h"
#include "overlap/separation.h"
#include "overlap/source.h"

// What is asked of the model, row by row where not all pairs are.
typedef struct Asked {
  int *rows; // of the batch                                  (count)
  double *pairs, *volume, *gradient, *centroid;
  size_t row_capacity, pair_capacity, volume_capacity, gradient_capacity, centroid_capacity;
  int count;
} Asked;

typedef struct Foreign {
  OverlapOps ops;
  char name[128];
  OverlapForeignPort port;
  bool keeps_ghosts;
  pthread_mutex_t lock; // of all below, and of the port
  Asked asked;
} Foreign;

static void destroy(void *self) {
  Foreign *foreign = self;
  if (foreign->port.close) foreign->port.close(foreign->port.self);
  Asked *asked = &foreign->asked;
  memory_free(asked->rows), memory_free(asked->pairs), memory_free(asked->volume);
  memory_free(asked->gradient), memory_free(asked->centroid);
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
  return (((const Foreign *)self)->port.gives & TETLAP_MODEL_GRADIENT) != 0;
}

static double volume_of(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

// Why a pair is not asked for: its flag; 0: it is asked for.
static unsigned answer_unasked(const Foreign *foreign, const double pair[24]) {
  if (!(volume_of(pair) > 0) || !(volume_of(pair + 12) > 0)) return OVERLAP_FLAT;
  if (foreign->keeps_ghosts || foreign->port.gives & TETLAP_MODEL_DISJOINT) return 0;
  return overlap_separation_pair(pair, 0) >= 0 ? OVERLAP_DISJOINT : 0;
}

static Status reserve(Asked *asked, const OverlapBatch *batch) {
  const size_t count = (size_t)batch->pair_count, wide = count * OVERLAP_PAIR_SIZE;
  bool fits = memory_reserve((void **)&asked->rows, &asked->row_capacity, count, sizeof *asked->rows) &&
              memory_reserve((void **)&asked->pairs, &asked->pair_capacity, wide, sizeof *asked->pairs) &&
              memory_reserve((void **)&asked->volume, &asked->volume_capacity, count, sizeof *asked->volume);
  if (fits && batch->gradient)
    fits =
        memory_reserve((void **)&asked->gradient, &asked->gradient_capacity, wide, sizeof *asked->gradient);
  if (fits && batch->centroid)
    fits = memory_reserve((void **)&asked->centroid, &asked->centroid_capacity, 3 * count,
                          sizeof *asked->centroid);
  return fits ? STATUS_OK : status_no_memory("pairs for a model");
}

static void choose(const Foreign *foreign, Asked *asked, const OverlapBatch *batch) {
  asked->count = 0;
  for (int i = 0; i < batch->pair_count; i++) {
    unsigned flags = 0;
    const double *pair = batch->pairs + (size_t)i * OVERLAP_PAIR_SIZE;
    OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
    overlap_ops_write_nothing(&answer);
    *answer.flags = answer_unasked(foreign, pair);
    if (*answer.flags) continue;
    memcpy(asked->pairs + (size_t)asked->count * OVERLAP_PAIR_SIZE, pair, OVERLAP_PAIR_SIZE * sizeof *pair);
    asked->rows[asked->count++] = i;
  }
}

static bool are_finite(int count, const double *numbers) {
  double sum = 0; // x − x is 0 for finite x, else NaN
  for (int i = 0; i < count; i++) sum += numbers[i] - numbers[i];
  return sum == 0;
}

// All that is wanted is NaN before the model is asked: what it leaves unwritten is no answer.
static Status ask(const Foreign *foreign, const TetlapModelBatch *batch) {
  const size_t bytes = batch->count * sizeof(double);
  memset(batch->volume, 0xFF, bytes);
  if (batch->gradient) memset(batch->gradient, 0xFF, 24 * bytes);
  if (batch->centroid) memset(batch->centroid, 0xFF, 3 * bytes);
  if (batch->logit) memset(batch->logit, 0xFF, bytes);
  if (batch->doubt) memset(batch->doubt, 0xFF, bytes);
  return foreign->port.ask(foreign->port.self, batch);
}

static Status fail_not_finite(const Foreign *foreign, int pair, const char *what) {
  return status_fail(STATUS_SOLVER, "overlap model '%s': pair %d: %s is not a finite number", foreign->name,
                     pair, what);
}

// The model's answer for pair k of those asked, into the batch.
static Status give(const Foreign *foreign, const Asked *asked, const OverlapBatch *batch, int k) {
  const int i = asked->rows[k];
  const size_t at = (size_t)k;
  unsigned flags = 0;
  OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
  const double volume = asked->volume[at], *pair = asked->pairs + OVERLAP_PAIR_SIZE * at;
  if (!isfinite(volume)) return fail_not_finite(foreign, i, "its volume");
  const double most = fmin(volume_of(pair), volume_of(pair + 12));
  if (volume < 0 || volume > most * (1 + 1e-9)) *answer.flags |= OVERLAP_UNSOUND;
  if (!(volume > 0)) return STATUS_OK;
  *answer.volume = volume;
  if (answer.gradient) {
    if (!are_finite(24, asked->gradient + 24 * at)) return fail_not_finite(foreign, i, "a gradient of it");
    memcpy(answer.gradient, asked->gradient + 24 * at, 24 * sizeof(double));
  }
  if (answer.centroid) {
    if (!are_finite(3, asked->centroid + 3 * at)) return fail_not_finite(foreign, i, "its centroid");
    memcpy(answer.centroid, asked->centroid + 3 * at, 3 * sizeof(double));
  }
  return STATUS_OK;
}

static Status eval(Foreign *foreign, const OverlapBatch *batch) {
  Asked *asked = &foreign->asked;
  TRY(reserve(asked, batch));
  choose(foreign, asked, batch);
  if (asked->count == 0) return STATUS_OK;
  TetlapModelBatch request = {.size = sizeof request,
                              .count = (size_t)asked->count,
                              .pairs = asked->pairs,
                              .volume = asked->volume,
                              .gradient = batch->gradient ? asked->gradient : NULL,
                              .centroid = batch->centroid ? asked->centroid : NULL};
  Status status = ask(foreign, &request);
  for (int k = 0; k < asked->count && !status; k++) status = give(foreign, asked, batch, k);
  return status;
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

// All pairs as they stand; `needed` is the array that must be finite.
static Status eval_all(Foreign *foreign, const TetlapModelBatch *request, const double *needed,
                       const char *what) {
  if (request->count == 0) return STATUS_OK;
  pthread_mutex_lock(&foreign->lock);
  Status status = ask(foreign, request);
  pthread_mutex_unlock(&foreign->lock);
  for (size_t i = 0; i < request->count && !status; i++)
    if (!isfinite(needed[i])) status = fail_not_finite(foreign, (int)i, what);
  return status;
}

static Status eval_logits(const void *self, int count, const double *pairs, double *logits) {
  double *volumes = memory_zeroed((size_t)count + 1, sizeof *volumes);
  if (!volumes) return status_no_memory("volumes of pairs");
  TetlapModelBatch request = {
      .size = sizeof request, .count = (size_t)count, .pairs = pairs, .volume = volumes, .logit = logits};
  Status status = eval_all((Foreign *)self, &request, logits, "its logit");
  memory_free(volumes);
  return status;
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  TetlapModelBatch request = {
      .size = sizeof request, .count = (size_t)count, .pairs = pairs, .volume = volumes, .doubt = bounds};
  return eval_all((Foreign *)self, &request, bounds, "its doubt");
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
  *self = foreign, *ops = &foreign->ops;
  return STATUS_OK;
}

Status overlap_foreign_hand_on(const char *word) {
  return overlap_foreign_process_hand_on(word);
}
