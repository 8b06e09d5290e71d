// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/geo/pool.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/task.h"
#include "base/memory.h"
#include "base/text.h"
#include "overlap/geo/geo.h"

enum { SIZE = 24, RATES = APP_POOL_RATES, MAX = OVERLAP_GEO_MAX_FEATURES };

void app_training_pool_destroy(AppTrainingPool *pool) {
  memory_free(pool->inputs), memory_free(pool->rates), memory_free(pool->onset);
  memory_free(pool->targets), memory_free(pool->target_rates);
  net_whitening_destroy(&pool->whitening);
  *pool = (AppTrainingPool){0};
}

static double dot(const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < SIZE; i++) sum += a[i] * b[i];
  return sum;
}

// Takes off what is along the first `count` vectors and scales to length 1; returns the share of its length
// that was left.
static double orthonormalise(const double *vectors, int count, double *vector) {
  double before = sqrt(dot(vector, vector));
  for (int pass = 0; pass < 2; pass++)
    for (int v = 0; v < count; v++) {
      double along = dot(vectors + v * SIZE, vector);
      for (int i = 0; i < SIZE; i++) vector[i] -= along * vectors[v * SIZE + i];
    }
  double after = sqrt(dot(vector, vector));
  for (int i = 0; i < SIZE; i++) vector[i] /= after;
  return after / before;
}

// First the affine directions, about the vertices' mean so that they are well apart, then unit vectors as
// long as they say something new.
void app_training_pool_basis(const double pair[24], double basis[APP_POOL_RATES * 24]) {
  double vectors[SIZE * SIZE], mean[3] = {0};
  int count = 0;
  for (int i = 0; i < SIZE; i++) mean[i % 3] += pair[i] / 8;
  for (int column = 0; column < 4; column++)
    for (int row = 0; row < 3; row++) {
      double *vector = vectors + count * SIZE;
      memset(vector, 0, SIZE * sizeof(double));
      for (int v = 0; v < 8; v++) vector[3 * v + row] = column < 3 ? pair[3 * v + column] - mean[column] : 1;
      orthonormalise(vectors, count++, vector);
    }
  for (double least = 0.3; count < SIZE; least /= 2)
    for (int i = 0; i < SIZE && count < SIZE; i++) {
      double *vector = vectors + count * SIZE;
      memset(vector, 0, SIZE * sizeof(double));
      vector[i] = 1;
      count += orthonormalise(vectors, count, vector) > least;
    }
  memcpy(basis, vectors + RATES * SIZE, RATES * SIZE * sizeof(double));
}

// The pairs that have a frame, by their number, and their features.
typedef struct Kept {
  int count;
  long long apart;  // pairs that share no volume
  int *index;       // (count)
  double *features; // (count, features)
} Kept;

static bool is_kept(const OverlapGeoFeatureSet *set, const DatagenPairs *pairs, size_t i, double *features) {
  double volume;
  if (!(pairs->volume[i] > 0)) return false;
  return overlap_geo_features_tangent(set, pairs->coordinates + i * SIZE, 0, NULL, features, NULL, &volume,
                                      NULL) == OVERLAP_GEO_INSIDE;
}

static Status keep_features(Kept *kept, const OverlapGeoFeatureSet *set, const DatagenPairs *pairs,
                            size_t count) {
  size_t n = (size_t)set->count;
  kept->index = memory_zeroed(count, sizeof *kept->index);
  kept->features = memory_zeroed(count * n, sizeof *kept->features);
  if (!kept->index || !kept->features) return status_no_memory("the training's features");
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t i = 0; i < count; i++) kept->index[i] = is_kept(set, pairs, i, kept->features + i * n);
  for (size_t i = 0; i < count; i++) {
    kept->apart += !(pairs->volume[i] > 0);
    if (!kept->index[i]) continue;
    memmove(kept->features + (size_t)kept->count * n, kept->features + i * n, n * sizeof(double));
    kept->index[kept->count++] = (int)i;
  }
  if (kept->count < 2)
    return status_fail(STATUS_INPUT, "of %zu pairs to train on %d share volume", count, kept->count);
  return STATUS_OK;
}

static Status copy_whitening(const NetWhitening *from, NetWhitening *to) {
  TRY(app_training_task_fail(net_whitening_create(from->count, to)));
  size_t n = (size_t)from->count;
  memcpy(to->mean, from->mean, n * sizeof(double));
  memcpy(to->matrix, from->matrix, n * n * sizeof(double));
  return STATUS_OK;
}

// Mᵀ, so that a product runs along rows.
static void transpose(const NetWhitening *whitening, double *transposed) {
  for (int i = 0; i < whitening->count; i++)
    for (int j = 0; j < whitening->count; j++)
      transposed[j * whitening->count + i] = whitening->matrix[i * whitening->count + j];
}

// out = factor · M (in − mean), the mean only if it is not NULL.
static void whiten(int n, const double *transposed, const double *mean, double factor, const double *in,
                   float *out) {
  double sum[MAX] = {0};
  for (int j = 0; j < n; j++) {
    double x = in[j] - (mean ? mean[j] : 0);
    for (int i = 0; i < n; i++) sum[i] += transposed[j * n + i] * x;
  }
  for (int i = 0; i < n; i++) out[i] = (float)(factor * sum[i]);
}

static void fill(AppTrainingPool *pool, const DatagenPairs *pairs, size_t from, size_t to,
                 const double *transposed) {
  const OverlapGeoFeatureSet *set = pool->set;
  size_t n = (size_t)set->count;
  const double *pair = pairs->coordinates + from * SIZE, *gradient = pairs->gradient + from * SIZE;
  double volume = pairs->volume[from], scale = volume / sqrt(dot(gradient, gradient));
  double basis[RATES * SIZE], features[MAX], changes[RATES * MAX], guess, guess_changes[RATES];
  app_training_pool_basis(pair, basis);
  overlap_geo_features_tangent(set, pair, RATES, basis, features, changes, &guess, guess_changes);
  whiten(set->count, transposed, pool->whitening.mean, 1, features, pool->inputs + to * n);
  pool->targets[to] = (float)(log(volume) - guess);
  for (size_t q = 0; q < RATES; q++) {
    whiten(set->count, transposed, NULL, scale, changes + q * n, pool->rates + (to * RATES + q) * n);
    double change = dot(gradient, basis + q * SIZE) / volume - guess_changes[q];
    pool->target_rates[to * RATES + q] = (float)(scale * change);
  }
}

// A network that only remembers what it is asked first: a model asks for the value at the onset.
typedef struct Capture {
  int count;
  double features[MAX];
} Capture;

static Status capture(const void *self, int count, const double *features, double *value, double *gradient) {
  Capture *captured = *(Capture *const *)self;
  (void)gradient;
  memcpy(captured->features, features, (size_t)captured->count * sizeof(double));
  for (int n = 0; n < count; n++) value[n] = 0;
  return STATUS_OK;
}

static Status fill_onset(AppTrainingPool *pool, const double *transposed) {
  Capture captured = {.count = pool->set->count}, *place = &captured;
  OverlapGeoNetwork network = {.self = &place, .feature_count = pool->set->count, .eval = capture};
  OverlapGeoModel model;
  TRY(overlap_geo_create(&model, &network));
  whiten(pool->set->count, transposed, pool->whitening.mean, 1, captured.features, pool->onset);
  return STATUS_OK;
}

static Status fill_all(AppTrainingPool *pool, const DatagenPairs *pairs, const Kept *kept) {
  size_t n = (size_t)pool->set->count, count = (size_t)kept->count;
  double *transposed = memory_zeroed(n * n, sizeof *transposed);
  pool->inputs = memory_zeroed(count * n, sizeof(float));
  pool->rates = memory_zeroed(count * n * RATES, sizeof(float));
  pool->targets = memory_zeroed(count, sizeof(float));
  pool->target_rates = memory_zeroed(count * RATES, sizeof(float));
  pool->onset = memory_zeroed(n, sizeof(float));
  bool fits = transposed && pool->inputs && pool->rates && pool->targets && pool->target_rates && pool->onset;
  Status status = fits ? STATUS_OK : status_no_memory("the training's samples");
  if (!status) {
    transpose(&pool->whitening, transposed);
    status = fill_onset(pool, transposed);
  }
  if (!status) {
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t k = 0; k < count; k++) fill(pool, pairs, (size_t)kept->index[k], k, transposed);
  }
  memory_free(transposed);
  return status;
}

static Status create(AppTrainingPool *pool, const DatagenPairs *pairs, size_t count,
                     const NetWhitening *whitening, Kept *kept) {
  TRY(keep_features(kept, pool->set, pairs, count));
  pool->count = kept->count;
  pool->apart = kept->apart;
  pool->unfit = (long long)count - kept->count - kept->apart;
  if (whitening->count)
    TRY(copy_whitening(whitening, &pool->whitening));
  else
    TRY(app_training_task_fail(
        net_whitening_fit(pool->set->count, kept->count, kept->features, &pool->whitening)));
  return fill_all(pool, pairs, kept);
}

void app_training_pool_describe(const AppTrainingPool *pool, long long unanswered, char *text, size_t size) {
  const struct {
    long long count;
    const char *reason;
  } causes[] = {{pool->apart - unanswered, "share no volume"},
                {unanswered, "are not answered by the network that is bounded"},
                {pool->unfit, "are too flat for the features"}};
  long long left_out = pool->apart + pool->unfit;
  size_t used = 0;
  text_append(text, size, &used, "%d pairs to train on", pool->count);
  if (left_out > 0) text_append(text, size, &used, "; %lld left out", left_out);
  const char *before = ": ";
  for (int k = 0; k < 3; k++) {
    if (causes[k].count == 0) continue;
    text_append(text, size, &used, "%s%lld %s", before, causes[k].count, causes[k].reason);
    before = ", ";
  }
}

Status app_training_pool_create(AppTrainingPool *pool, const OverlapGeoFeatureSet *set,
                                const DatagenPairs *pairs, size_t count, const NetWhitening *whitening) {
  *pool = (AppTrainingPool){.set = set};
  Kept kept = {0};
  Status status = create(pool, pairs, count, whitening, &kept);
  memory_free(kept.index), memory_free(kept.features);
  if (status) app_training_pool_destroy(pool);
  return status;
}
