// SPDX-License-Identifier: GPL-3.0-or-later
// Training of `geo`: φ = ln 1.28 + ρ(w) − ρ(w*) against t = ln V − ln V₀ and against its derivatives along
// random directions, w the whitened features and w* those of the onset. The onset is one more sample of each
// batch, whose derivative is minus the sum of all others'. If the network gives the centroid too, its other
// outputs are coefficients of vectors that shall sum to the centroid's z (vectors.h).
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/geo/fold.h"
#include "app/training/geo/pool.h"
#include "app/training/geo/vectors.h"
#include "app/training/sets.h"
#include "app/training/start.h"
#include "app/training/task.h"
#include "base/memory.h"
#include "overlap/geo/network.h"

typedef struct Geo {
  AppTrainingPool pool;
  AppTrainingVectors vectors; // zeroed: no centroid
  AppTrainingOrder order;
  AppTrainingSets sets;
  int *samples;             // (batch)
  float *x, *xt;            // (batch + 1, features), (batch + 1, tangents, features)
  int outputs;              // of the network
  float *y, *yt, *gy, *gyt; // (batch + 1, outputs), (batch + 1, tangents, outputs)
  float *rho, *rho_t;       // first of the outputs, then its derivatives (batch + 1), (batch + 1, tangents)
  float *slope, *slope_t;   // of the loss, likewise
  float *target, *target_t, *one; // (batch), (batch, tangents), (batch)
} Geo;

static int tangents_of(const AppTrainingConfig *config) {
  return config->loss.tangents;
}

static NetShape shape(const AppTrainingConfig *config) {
  int outputs = 1;
  if (config->model.has_centroid)
    outputs += overlap_geo_features_plane_count(overlap_geo_features_set(config->model.features));
  return net_shape_mlp(config->model.features, config->model.width, config->model.depth, outputs);
}

static void destroy(AppTrainingTask *task) {
  Geo *geo = task->self;
  if (!geo) return;
  app_training_pool_destroy(&geo->pool);
  app_training_vectors_destroy(&geo->vectors);
  app_training_order_destroy(&geo->order);
  app_training_sets_destroy(&geo->sets);
  memory_free(geo->samples), memory_free(geo->x), memory_free(geo->xt), memory_free(geo->y);
  memory_free(geo->yt), memory_free(geo->gy), memory_free(geo->gyt), memory_free(geo->target);
  memory_free(geo->target_t), memory_free(geo->one), memory_free(geo->rho), memory_free(geo->rho_t);
  memory_free(geo->slope), memory_free(geo->slope_t), memory_free(geo);
  task->self = NULL;
}

static Status load_pool(AppTrainingTask *task, const NetWhitening *whitening) {
  Geo *geo = task->self;
  DatagenPairs pairs;
  size_t count;
  TRY(app_training_sets_load_pairs(task->config, &pairs, &count));
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(task->config->model.features);
  Status status = app_training_pool_create(&geo->pool, set, &pairs, count, whitening);
  if (!status && task->config->model.has_centroid)
    status = app_training_vectors_create(&geo->vectors, set, &pairs, count);
  datagen_pairs_destroy(&pairs);
  return status;
}

static Status create_batch(Geo *geo, const AppTrainingConfig *config) {
  size_t batch = (size_t)config->optimiser.batch, rows = batch + 1, n = (size_t)config->model.features,
         tangents = (size_t)config->loss.tangents, outputs = 1 + (size_t)geo->vectors.vector_count;
  geo->outputs = (int)outputs;
  geo->samples = memory_zeroed(batch, sizeof *geo->samples);
  geo->x = memory_zeroed(rows * n, sizeof(float)),
  geo->xt = memory_zeroed(rows * tangents * n, sizeof(float));
  geo->y = memory_zeroed(rows * outputs, sizeof(float));
  geo->yt = memory_zeroed(rows * tangents * outputs, sizeof(float));
  geo->gy = memory_zeroed(rows * outputs, sizeof(float));
  geo->gyt = memory_zeroed(rows * tangents * outputs, sizeof(float));
  geo->rho = memory_zeroed(rows, sizeof(float)), geo->rho_t = memory_zeroed(rows * tangents, sizeof(float));
  geo->slope = memory_zeroed(rows, sizeof(float)),
  geo->slope_t = memory_zeroed(rows * tangents, sizeof(float));
  geo->target = memory_zeroed(batch, sizeof(float)), geo->one = memory_zeroed(batch, sizeof(float));
  geo->target_t = memory_zeroed(batch * tangents, sizeof(float));
  bool fits = geo->samples && geo->x && geo->xt && geo->y && geo->yt && geo->gy && geo->gyt && geo->target &&
              geo->one && geo->target_t && geo->rho && geo->rho_t && geo->slope && geo->slope_t;
  if (!fits) return status_no_memory("a batch");
  for (size_t k = 0; k < batch; k++) geo->one[k] = (float)config->loss.tangent_scale;
  memcpy(geo->x + batch * n, geo->pool.onset, n * sizeof(float));
  return STATUS_OK;
}

static Status create(AppTrainingTask *task, const NetWhitening *whitening) {
  Geo *geo = task->self = memory_zeroed(1, sizeof *geo);
  if (!geo) return status_no_memory("a training");
  TRY(load_pool(task, whitening));
  TRY(app_training_sets_load(&geo->sets, task->config));
  TRY(app_training_order_create(&geo->order, geo->pool.count));
  app_training_pool_describe(&geo->pool, 0, task->summary, sizeof task->summary);
  return create_batch(geo, task->config);
}

// Row k of the batch: sample `from` along directions drawn from a stream of the row's own.
static void fill_row(Geo *geo, const AppTrainingConfig *config, NetRandom random, int k, int from) {
  const AppTrainingPool *pool = &geo->pool;
  size_t n = (size_t)pool->set->count, row = (size_t)k, at = (size_t)from;
  int tangents = config->loss.tangents;
  memcpy(geo->x + row * n, pool->inputs + at * n, n * sizeof(float));
  geo->target[k] = pool->targets[from];
  for (int t = 0; t < tangents; t++) {
    float *xt = geo->xt + (row * (size_t)tangents + (size_t)t) * n, sum = 0;
    memset(xt, 0, n * sizeof(float));
    for (size_t q = 0; q < APP_POOL_RATES; q++) {
      float z = (float)net_random_normal(&random);
      const float *rates = pool->rates + (at * APP_POOL_RATES + q) * n;
      for (size_t i = 0; i < n; i++) xt[i] += z * rates[i];
      sum += z * pool->target_rates[at * APP_POOL_RATES + q];
    }
    geo->target_t[k * tangents + t] = sum;
  }
}

// Of ρ and its tangents; the derivatives go to the first outputs.
static double volume_loss(Geo *geo, const AppTrainingConfig *config) {
  int batch = config->optimiser.batch, tangents = config->loss.tangents, outputs = geo->outputs;
  float onset = geo->y[batch * outputs], sum = 0;
  for (int k = 0; k < batch; k++) geo->rho[k] = geo->y[k * outputs] + (float)log(1.28) - onset;
  for (int k = 0; k < batch * tangents; k++) geo->rho_t[k] = geo->yt[k * outputs];
  double loss = net_loss_sobolev_f32(batch, tangents, config->loss.huber, geo->rho, geo->rho_t, geo->target,
                                     geo->target_t, geo->one, geo->slope, geo->slope_t);
  for (int k = 0; k < batch; k++) {
    geo->gy[k * outputs] = geo->slope[k];
    sum += geo->slope[k];
  }
  for (int k = 0; k < batch * tangents; k++) geo->gyt[k * outputs] = geo->slope_t[k];
  geo->gy[batch * outputs] = -sum;
  return loss;
}

// Of the other outputs, to which its derivatives go.
static double centroid_loss(Geo *geo, const AppTrainingConfig *config) {
  int batch = config->optimiser.batch, outputs = geo->outputs;
  float factor = (float)(config->loss.centroid / batch);
  double sum = 0;
  for (int k = 0; k < batch; k++) {
    float *gy = geo->gy + k * outputs + 1;
    sum += app_training_vectors_loss(&geo->vectors, geo->samples[k], config->loss.huber,
                                     geo->y + k * outputs + 1, gy);
    for (int m = 0; m < outputs - 1; m++) gy[m] *= factor;
  }
  return config->loss.centroid * sum / batch;
}

static double step(AppTrainingTask *task, const NetModel_f32 *model, NetWork_f32 *work, long long number,
                   float *gradient) {
  Geo *geo = task->self;
  const AppTrainingConfig *config = task->config;
  int batch = config->optimiser.batch, tangents = config->loss.tangents;
  app_training_order_take(&geo->order, config->seed, number, batch, geo->samples);
  uint64_t stream = 2 * ((uint64_t)number * (uint64_t)batch) + 1;
#pragma omp parallel for schedule(dynamic, 32) num_threads(work->def.thread_count)
  for (int k = 0; k < batch; k++)
    fill_row(geo, config, net_random_seeded((uint64_t)config->seed, stream + 2 * (uint64_t)k), k,
             geo->samples[k]);
  net_gradient_forward_f32(work, model, batch + 1, tangents, geo->x, geo->xt, geo->y, geo->yt);
  double loss = volume_loss(geo, config);
  if (config->model.has_centroid) loss += centroid_loss(geo, config);
  net_gradient_backward_f32(work, model, batch + 1, tangents, geo->gy, geo->gyt, gradient);
  return loss;
}

static void fold_vectors(const void *self, NetModel_f64 *folded) {
  const Geo *geo = self;
  if (geo->outputs > 1) app_training_vectors_fold(&geo->vectors.whitening, folded);
}

static Status write(const AppTrainingTask *task, const NetModel_f32 *model, const char *provenance,
                    const char *path) {
  const Geo *geo = task->self;
  char range[256], normalisation[] = OVERLAP_GEO_NORMALISATION;
  snprintf(range, sizeof range,
           "any pair of tetrahedra with det / (longest edge)^3 of at least 1e-5 that has an analytic centre; "
           "pinned to ln 1.28 at the onset; feature set '%s'",
           geo->pool.set->name);
  AppTrainingFold fold = {.model = model,
                          .whitening = &geo->pool.whitening,
                          .normalisation = normalisation,
                          .range = range,
                          .provenance = provenance,
                          .finish = fold_vectors,
                          .self = geo};
  return app_training_fold_write(&fold, path);
}

static double score(const AppEvaluation *result, const char *set, AppTrainingScores *scores) {
  app_training_scores_add(scores, set, "mae", result->mae);
  app_training_scores_add(scores, set, "volume_error", result->volume_error_sum);
  app_training_scores_add(scores, set, "gradient_error", result->gradient_error);
  app_training_scores_add(scores, set, "angle_p90", result->angle_p90_deg);
  if (isnan(result->moment_error)) return result->volume_error_sum + result->gradient_error;
  app_training_scores_add(scores, set, "moment_error", result->moment_error);
  return result->volume_error_sum + result->gradient_error + result->moment_error;
}

// The file is read back: what is measured is the model as scenes will have it.
static Status validate(AppTrainingTask *task, const NetModel_f32 *model, const char *path,
                       AppTrainingScores *scores) {
  const Geo *geo = task->self;
  TRY(write(task, model, "a training in progress", path));
  return app_training_sets_measure(&geo->sets, path, score, scores);
}

static Status start(AppTrainingTask *task, NetModel_f32 *model) {
  const Geo *geo = task->self;
  return app_training_start_read(task->config->start, OVERLAP_GEO_NORMALISATION, &geo->pool.whitening,
                                 geo->outputs > 1 ? &geo->vectors.whitening : NULL, model);
}

static const NetWhitening *whitening_of(const AppTrainingTask *task) {
  return &((const Geo *)task->self)->pool.whitening;
}

const AppTrainingTaskOps app_training_geo = {
    .shape = shape,
    .create = create,
    .start = start,
    .rows = 1,
    .tangents = tangents_of,
    .step = step,
    .validate = validate,
    .write = write,
    .whitening = whitening_of,
    .destroy = destroy,
};
