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

// The arrays of a request, in the order of their widths.
enum { PAIRS, VOLUME, GRADIENT, CENTROID, LOGIT, DOUBT, ARRAYS };
static const struct {
  const char *name;
  size_t width; // numbers a pair
} shapes[ARRAYS] = {{"pairs", 24},   {"volume", 1}, {"gradient", 24},
                    {"centroid", 3}, {"logit", 1},  {"doubt", 1}};

// Behind each array stand numbers that no model may touch: a row of the widest.
enum { FENCE = 24 };
static const unsigned char FENCE_BYTE = 0xA5;

// What is asked of the model, row by row where not all pairs are.
typedef struct Asked {
  int *rows; // of the batch                                  (count)
  size_t row_capacity;
  int count;
  double *arrays[ARRAYS]; // each with its fence           (count, width)
  size_t capacities[ARRAYS];
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
  memory_free(asked->rows);
  for (int a = 0; a < ARRAYS; a++) memory_free(asked->arrays[a]);
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

static Status reserve(Asked *asked, size_t count, const bool is_wanted[ARRAYS]) {
  bool fits = memory_reserve((void **)&asked->rows, &asked->row_capacity, count, sizeof *asked->rows);
  for (int a = 0; a < ARRAYS && fits; a++)
    if (is_wanted[a])
      fits = memory_reserve((void **)&asked->arrays[a], &asked->capacities[a],
                            count * shapes[a].width + FENCE, sizeof(double));
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
    memcpy(asked->arrays[PAIRS] + (size_t)asked->count * OVERLAP_PAIR_SIZE, pair,
           OVERLAP_PAIR_SIZE * sizeof *pair);
    asked->rows[asked->count++] = i;
  }
}

static bool are_finite(int count, const double *numbers) {
  double sum = 0; // x − x is 0 for finite x, else NaN
  for (int i = 0; i < count; i++) sum += numbers[i] - numbers[i];
  return sum == 0;
}

static bool is_whole(const unsigned char *fence) {
  bool is = true;
  for (size_t i = 0; i < FENCE * sizeof(double); i++) is = is && fence[i] == FENCE_BYTE;
  return is;
}

// All that is wanted is NaN before the model is asked: what it leaves unwritten is no answer. A fence that is
// not whole afterwards ends the run: what else was overwritten nobody knows.
static Status ask(Foreign *foreign, const bool is_wanted[ARRAYS]) {
  Asked *asked = &foreign->asked;
  double *arrays[ARRAYS] = {NULL};
  const size_t count = (size_t)asked->count;
  for (int a = 0; a < ARRAYS; a++) {
    if (!is_wanted[a]) continue;
    arrays[a] = asked->arrays[a];
    if (a != PAIRS) memset(arrays[a], 0xFF, count * shapes[a].width * sizeof(double));
    memset(arrays[a] + count * shapes[a].width, FENCE_BYTE, FENCE * sizeof(double));
  }
  TetlapModelBatch request = {.size = sizeof request,
                              .count = count,
                              .pairs = arrays[PAIRS],
                              .volume = arrays[VOLUME],
                              .gradient = arrays[GRADIENT],
                              .centroid = arrays[CENTROID],
                              .logit = arrays[LOGIT],
                              .doubt = arrays[DOUBT]};
  TRY(foreign->port.ask(foreign->port.self, &request));
  for (int a = 0; a < ARRAYS; a++)
    if (arrays[a] && !is_whole((const unsigned char *)(arrays[a] + count * shapes[a].width)))
      return status_fail(
          STATUS_SOLVER,
          "overlap model '%s' wrote beyond the end of `%s`, which has %zu rows of %zu: it must "
          "write `count` rows of each array and no more",
          foreign->name, shapes[a].name, count, shapes[a].width);
  return STATUS_OK;
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
  const double *pair = batch->pairs + (size_t)i * OVERLAP_PAIR_SIZE, *const *arrays =
                                                                         (const double *const *)asked->arrays;
  const double volume = arrays[VOLUME][at];
  if (!isfinite(volume)) return fail_not_finite(foreign, i, "its volume");
  const double most = fmin(volume_of(pair), volume_of(pair + 12));
  if (volume < 0 || volume > most * (1 + 1e-9)) *answer.flags |= OVERLAP_UNSOUND;
  if (!(volume > 0)) return STATUS_OK;
  *answer.volume = volume;
  if (answer.gradient) {
    if (!are_finite(24, arrays[GRADIENT] + 24 * at)) return fail_not_finite(foreign, i, "a gradient of it");
    memcpy(answer.gradient, arrays[GRADIENT] + 24 * at, 24 * sizeof(double));
  }
  if (answer.centroid) {
    if (!are_finite(3, arrays[CENTROID] + 3 * at)) return fail_not_finite(foreign, i, "its centroid");
    memcpy(answer.centroid, arrays[CENTROID] + 3 * at, 3 * sizeof(double));
  }
  return STATUS_OK;
}

static Status eval(Foreign *foreign, const OverlapBatch *batch) {
  Asked *asked = &foreign->asked;
  const bool is_wanted[ARRAYS] = {[PAIRS] = true,
                                  [VOLUME] = true,
                                  [GRADIENT] = batch->gradient != NULL,
                                  [CENTROID] = batch->centroid != NULL};
  TRY(reserve(asked, (size_t)batch->pair_count, is_wanted));
  choose(foreign, asked, batch);
  if (asked->count == 0) return STATUS_OK;
  Status status = ask(foreign, is_wanted);
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

// V, where it is wanted, and array `what` of all pairs as they stand.
static Status eval_all(Foreign *foreign, int count, const double *pairs, double *volumes, int what,
                       double *numbers) {
  Asked *asked = &foreign->asked;
  const size_t bytes = (size_t)count * sizeof(double);
  const bool is_wanted[ARRAYS] = {
      [PAIRS] = true, [VOLUME] = true, [LOGIT] = what == LOGIT, [DOUBT] = what == DOUBT};
  TRY(reserve(asked, (size_t)count, is_wanted));
  memcpy(asked->arrays[PAIRS], pairs, OVERLAP_PAIR_SIZE * bytes);
  asked->count = count;
  TRY(ask(foreign, is_wanted));
  memcpy(numbers, asked->arrays[what], bytes);
  if (volumes) memcpy(volumes, asked->arrays[VOLUME], bytes);
  for (int i = 0; i < count; i++)
    if (!isfinite(numbers[i])) return fail_not_finite(foreign, i, what == LOGIT ? "its logit" : "its doubt");
  return STATUS_OK;
}

static Status eval_all_locked(const void *self, int count, const double *pairs, double *volumes, int what,
                              double *numbers) {
  Foreign *foreign = (Foreign *)self;
  if (count == 0) return STATUS_OK;
  pthread_mutex_lock(&foreign->lock);
  Status status = eval_all(foreign, count, pairs, volumes, what, numbers);
  pthread_mutex_unlock(&foreign->lock);
  return status;
}

static Status eval_logits(const void *self, int count, const double *pairs, double *logits) {
  return eval_all_locked(self, count, pairs, NULL, LOGIT, logits);
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  return eval_all_locked(self, count, pairs, volumes, DOUBT, bounds);
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
