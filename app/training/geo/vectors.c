// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/geo/vectors.h"

#include <math.h>
#include <string.h>

#include "app/training/task.h"
#include "base/memory.h"
#include "overlap/geo/geo.h"

enum {
  SIZE = 24,
  MOST = OVERLAP_GEO_MAX_PLANE_FEATURES,
  FITTED = 10000, // pairs that the whitening is fitted to
  SIGNED = 6,     // samples that a pair gives for it: three components, with either sign
};

void app_training_vectors_destroy(AppTrainingVectors *vectors) {
  memory_free(vectors->vectors), memory_free(vectors->targets);
  net_whitening_destroy(&vectors->whitening);
  *vectors = (AppTrainingVectors){0};
}

// In double, as they come.
typedef struct Raw {
  bool *is_kept;   // (count)
  double *vectors; // (count, vectors, 3)
  double *z;       // (count, 3)
} Raw;

static void raw_destroy(Raw *raw) {
  memory_free(raw->is_kept), memory_free(raw->vectors), memory_free(raw->z);
}

static bool find_pair(const AppTrainingVectors *vectors, const DatagenPairs *pairs, size_t i, Raw *raw) {
  double features[OVERLAP_GEO_MAX_FEATURES];
  return pairs->volume[i] > 0 &&
         overlap_geo_features_centroid(
             vectors->set, pairs->coordinates + i * SIZE, pairs->centroid + i * 3, features, raw->z + i * 3,
             (double(*)[3])(raw->vectors + i * 3 * (size_t)vectors->vector_count)) == OVERLAP_GEO_INSIDE;
}

// The pairs that have a frame, moved together.
static Status find_raw(AppTrainingVectors *vectors, const DatagenPairs *pairs, size_t count, Raw *raw) {
  size_t m = 3 * (size_t)vectors->vector_count;
  raw->is_kept = memory_zeroed(count, sizeof *raw->is_kept);
  raw->vectors = memory_zeroed(count * m, sizeof(double));
  raw->z = memory_zeroed(count * 3, sizeof(double));
  if (!raw->is_kept || !raw->vectors || !raw->z) return status_no_memory("the training's vectors");
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t i = 0; i < count; i++) raw->is_kept[i] = find_pair(vectors, pairs, i, raw);
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    if (!raw->is_kept[i]) continue;
    memmove(raw->vectors + kept * m, raw->vectors + i * m, m * sizeof(double));
    memmove(raw->z + kept * 3, raw->z + i * 3, 3 * sizeof(double));
    kept++;
  }
  vectors->count = (int)kept;
  return STATUS_OK;
}

static Status fit(AppTrainingVectors *vectors, const double *raw) {
  int pairs = vectors->count < FITTED ? vectors->count : FITTED;
  size_t count = (size_t)vectors->vector_count;
  double *samples = memory_zeroed((size_t)pairs * SIGNED * count, sizeof(double));
  if (!samples) return status_no_memory("the training's vectors");
  for (size_t i = 0; i < (size_t)pairs; i++)
    for (size_t m = 0; m < count; m++)
      for (size_t c = 0; c < SIGNED; c++) {
        double x = raw[(i * count + m) * 3 + c % 3];
        samples[(i * SIGNED + c) * count + m] = c < 3 ? x : -x;
      }
  NetStatus status = net_whitening_fit((int)count, SIGNED * pairs, samples, &vectors->whitening);
  memory_free(samples);
  TRY(app_training_task_fail(status));
  // the samples' mean is the rounding of 0
  memset(vectors->whitening.mean, 0, count * sizeof(double));
  return STATUS_OK;
}

static void fill(AppTrainingVectors *vectors, const Raw *raw, size_t i) {
  size_t count = (size_t)vectors->vector_count;
  double rows[3 * MOST] = {0}, white[3 * MOST];
  for (size_t m = 0; m < count; m++)
    for (size_t c = 0; c < 3; c++) rows[c * count + m] = raw->vectors[(i * count + m) * 3 + c];
  net_whitening_apply(&vectors->whitening, 3, rows, white);
  for (size_t m = 0; m < count; m++)
    for (size_t c = 0; c < 3; c++) vectors->vectors[(i * count + m) * 3 + c] = (float)white[c * count + m];
  for (size_t c = 0; c < 3; c++) vectors->targets[i * 3 + c] = (float)raw->z[i * 3 + c];
}

static Status create(AppTrainingVectors *vectors, const DatagenPairs *pairs, size_t count, Raw *raw) {
  TRY(find_raw(vectors, pairs, count, raw));
  TRY(fit(vectors, raw->vectors));
  size_t kept = (size_t)vectors->count;
  vectors->vectors = memory_zeroed(kept * (size_t)vectors->vector_count * 3, sizeof(float));
  vectors->targets = memory_zeroed(kept * 3, sizeof(float));
  if (!vectors->vectors || !vectors->targets) return status_no_memory("the training's samples");
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < kept; i++) fill(vectors, raw, i);
  return STATUS_OK;
}

Status app_training_vectors_create(AppTrainingVectors *vectors, const OverlapGeoFeatureSet *set,
                                   const DatagenPairs *pairs, size_t count) {
  *vectors = (AppTrainingVectors){.set = set, .vector_count = overlap_geo_features_plane_count(set)};
  Raw raw = {0};
  Status status = create(vectors, pairs, count, &raw);
  raw_destroy(&raw);
  if (status) app_training_vectors_destroy(vectors);
  return status;
}

double app_training_vectors_loss(const AppTrainingVectors *vectors, int sample, double delta, const float *y,
                                 float *gy) {
  int count = vectors->vector_count;
  const float *v = vectors->vectors + 3 * (size_t)sample * (size_t)count,
              *z = vectors->targets + 3 * (size_t)sample;
  float error[3] = {-z[0], -z[1], -z[2]};
  for (int m = 0; m < count; m++)
    for (int c = 0; c < 3; c++) error[c] += y[m] * v[3 * m + c];
  double size = sqrt((double)(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]));
  float factor = (float)(size <= delta ? 1 : delta / size);
  for (int m = 0; m < count; m++)
    gy[m] = factor * (error[0] * v[3 * m] + error[1] * v[3 * m + 1] + error[2] * v[3 * m + 2]);
  return size <= delta ? size * size / 2 : delta * (size - delta / 2);
}

// Rows 1 … of a tensor: Aᵀ times them.
static void fold_rows(const NetWhitening *whitening, const NetTensor *tensor, double *numbers) {
  int count = whitening->count, columns = tensor->columns ? tensor->columns : 1;
  double column[MOST], *rows = numbers + columns;
  for (int j = 0; j < columns; j++) {
    for (int r = 0; r < count; r++) column[r] = rows[r * columns + j];
    for (int m = 0; m < count; m++) {
      double sum = 0;
      for (int r = 0; r < count; r++) sum += whitening->matrix[r * count + m] * column[r];
      rows[m * columns + j] = sum;
    }
  }
}

void app_training_vectors_fold(const NetWhitening *whitening, NetModel_f64 *model) {
  const NetPlan *plan = model->plan;
  for (int t = plan->tensor_count - 2; t < plan->tensor_count; t++) // the last weights and biases
    fold_rows(whitening, &plan->tensors[t], model->parameters + plan->tensors[t].offset);
}
