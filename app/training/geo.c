// SPDX-License-Identifier: GPL-3.0-or-later
// Training of `geo`: φ = ln 1.28 + ρ(w) − ρ(w*) against t = ln V − ln V₀ and against its derivatives along
// random directions, w the whitened features and w* those of the onset. The onset is one more sample of each
// batch, whose derivative is minus the sum of all others'.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/evaluation/evaluation.h"
#include "app/evaluation/model.h"
#include "app/training/pool.h"
#include "app/training/start.h"
#include "app/training/task.h"
#include "base/memory.h"
#include "overlap/geo/network.h"

enum { MAX_SETS = 6 };

typedef struct ValidationSet {
  char name[APP_TRAINING_SCORE_NAME];
  DatagenPairs pairs;
  size_t count;
} ValidationSet;

typedef struct Geo {
  AppTrainingPool pool;
  AppTrainingOrder order;
  ValidationSet sets[MAX_SETS];
  int set_count;
  int *samples;                   // (batch)
  float *x, *xt;                  // (batch + 1, features), (batch + 1, tangents, features)
  float *y, *yt, *gy, *gyt;       // (batch + 1), (batch + 1, tangents)
  float *target, *target_t, *one; // (batch), (batch, tangents), (batch)
} Geo;

static int tangents_of(const AppTrainingConfig *config) {
  return config->loss.tangents;
}

static NetShape shape(const AppTrainingConfig *config) {
  return net_shape_mlp(config->model.features, config->model.width, config->model.depth, 1);
}

static void destroy(AppTrainingTask *task) {
  Geo *geo = task->self;
  if (!geo) return;
  app_training_pool_destroy(&geo->pool);
  app_training_order_destroy(&geo->order);
  for (int s = 0; s < geo->set_count; s++) datagen_pairs_destroy(&geo->sets[s].pairs);
  memory_free(geo->samples), memory_free(geo->x), memory_free(geo->xt), memory_free(geo->y);
  memory_free(geo->yt), memory_free(geo->gy), memory_free(geo->gyt), memory_free(geo->target);
  memory_free(geo->target_t), memory_free(geo->one), memory_free(geo);
  task->self = NULL;
}

static Status load_sets(Geo *geo, const AppTrainingConfig *config) {
  if (config->validation_count > MAX_SETS)
    return status_fail(STATUS_INPUT, "%s: %d validation sets; at most %d", config->path,
                       config->validation_count, MAX_SETS);
  for (int s = 0; s < config->validation_count; s++) {
    AppSourceDef def = app_training_config_source(&config->validation[s]);
    ValidationSet *set = &geo->sets[s];
    snprintf(set->name, sizeof set->name, "set%d", s + 1);
    if (def.name) snprintf(set->name, sizeof set->name, "%s", def.name);
    TRY(app_dataset_source_load(&def, &set->pairs, &set->count));
    geo->set_count++;
  }
  return STATUS_OK;
}

// All sources one after another.
static Status load_pairs(const AppTrainingConfig *config, DatagenPairs *all, size_t *count) {
  for (int s = 0; s < config->training_count; s++) {
    AppSourceDef def = app_training_config_source(&config->training[s]);
    DatagenPairs more, joined;
    size_t more_count;
    TRY(app_dataset_source_load(&def, &more, &more_count));
    Status status = datagen_pairs_create(&joined, *count + more_count, true);
    if (!status) {
      memcpy(joined.coordinates, all->coordinates, *count * 24 * sizeof(double));
      memcpy(joined.gradient, all->gradient, *count * 24 * sizeof(double));
      memcpy(joined.volume, all->volume, *count * sizeof(double));
      memcpy(joined.coordinates + *count * 24, more.coordinates, more_count * 24 * sizeof(double));
      memcpy(joined.gradient + *count * 24, more.gradient, more_count * 24 * sizeof(double));
      memcpy(joined.volume + *count, more.volume, more_count * sizeof(double));
      datagen_pairs_destroy(all);
      *all = joined;
      *count += more_count;
    }
    datagen_pairs_destroy(&more);
    TRY(status);
  }
  return STATUS_OK;
}

static Status load_pool(AppTrainingTask *task, const NetWhitening *whitening) {
  Geo *geo = task->self;
  DatagenPairs pairs;
  size_t count = 0;
  TRY(datagen_pairs_create(&pairs, 0, true));
  Status status = load_pairs(task->config, &pairs, &count);
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(task->config->model.features);
  if (!status) status = app_training_pool_create(&geo->pool, set, &pairs, count, whitening);
  datagen_pairs_destroy(&pairs);
  return status;
}

static Status create_batch(Geo *geo, const AppTrainingConfig *config) {
  size_t batch = (size_t)config->optimiser.batch, rows = batch + 1, n = (size_t)config->model.features,
         tangents = (size_t)config->loss.tangents;
  geo->samples = memory_zeroed(batch, sizeof *geo->samples);
  geo->x = memory_zeroed(rows * n, sizeof(float)),
  geo->xt = memory_zeroed(rows * tangents * n, sizeof(float));
  geo->y = memory_zeroed(rows, sizeof(float)), geo->yt = memory_zeroed(rows * tangents, sizeof(float));
  geo->gy = memory_zeroed(rows, sizeof(float)), geo->gyt = memory_zeroed(rows * tangents, sizeof(float));
  geo->target = memory_zeroed(batch, sizeof(float)), geo->one = memory_zeroed(batch, sizeof(float));
  geo->target_t = memory_zeroed(batch * tangents, sizeof(float));
  bool fits = geo->samples && geo->x && geo->xt && geo->y && geo->yt && geo->gy && geo->gyt && geo->target &&
              geo->one && geo->target_t;
  if (!fits) return status_no_memory("a batch");
  for (size_t k = 0; k < batch; k++) geo->one[k] = (float)config->loss.tangent_scale;
  memcpy(geo->x + batch * n, geo->pool.onset, n * sizeof(float));
  return STATUS_OK;
}

static Status create(AppTrainingTask *task, const NetWhitening *whitening) {
  Geo *geo = task->self = memory_zeroed(1, sizeof *geo);
  if (!geo) return status_no_memory("a training");
  TRY(load_pool(task, whitening));
  TRY(load_sets(geo, task->config));
  TRY(app_training_order_create(&geo->order, geo->pool.count));
  task->sample_count = geo->pool.count;
  snprintf(task->summary, sizeof task->summary, "%d pairs to train on, %lld left out", geo->pool.count,
           geo->pool.left_out);
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
  float onset = geo->y[batch], sum = 0;
  for (int k = 0; k < batch; k++) geo->y[k] += (float)log(1.28) - onset;
  double loss = net_loss_sobolev_f32(batch, tangents, config->loss.huber, geo->y, geo->yt, geo->target,
                                     geo->target_t, geo->one, geo->gy, geo->gyt);
  for (int k = 0; k < batch; k++) sum += geo->gy[k];
  geo->gy[batch] = -sum;
  net_gradient_backward_f32(work, model, batch + 1, tangents, geo->gy, geo->gyt, gradient);
  return loss;
}

static Status fold_and_write(const Geo *geo, const NetModel_f32 *model, const NetCard *card, const char *path,
                             NetModel_f64 *folded) {
  net_model_widen(model, folded);
  TRY(app_training_task_fail(net_whitening_fold(&geo->pool.whitening, folded)));
  return app_training_task_fail(net_weights_write_f64(path, folded, card));
}

static Status write(const AppTrainingTask *task, const NetModel_f32 *model, const char *provenance,
                    const char *path) {
  const Geo *geo = task->self;
  char range[256], normalisation[] = OVERLAP_GEO_NORMALISATION, *story;
  snprintf(range, sizeof range,
           "any pair of tetrahedra with det / (longest edge)^3 of at least 1e-5 that has an analytic centre; "
           "pinned to ln 1.28 at the onset; feature set '%s'",
           geo->pool.set->name);
  story = memory_copy(provenance, strlen(provenance) + 1, 1);
  if (!story) return status_no_memory("the weights' provenance");
  NetCard card = {.normalisation = normalisation, .range = range, .provenance = story};
  NetModel_f64 folded = {0};
  Status status = app_training_task_fail(net_model_create_f64(&model->plan->shape, &folded));
  if (!status) status = fold_and_write(geo, model, &card, path, &folded);
  net_model_destroy_f64(&folded);
  memory_free(story);
  return status;
}

static Status measure(const OverlapModel *model, const ValidationSet *set, AppTrainingScores *scores) {
  AppEvaluationRun run;
  AppEvaluation result;
  app_evaluation_begin(&run, model, NULL);
  Status status = app_evaluation_add(&run, &set->pairs, set->count);
  if (!status) {
    app_evaluation_finish(&run, &result);
    app_training_scores_add(scores, set->name, "mae", result.mae);
    app_training_scores_add(scores, set->name, "volume_error", result.volume_error_sum);
    app_training_scores_add(scores, set->name, "gradient_error", result.gradient_error);
    app_training_scores_add(scores, set->name, "angle_p90", result.angle_p90_deg);
    // what the network did not answer is no merit of its
    double share = (double)result.fallbacks / (double)result.count;
    scores->score += result.volume_error_sum + result.gradient_error + share;
  }
  app_evaluation_end(&run);
  return status;
}

// The file is read back: what is measured is the model as scenes will have it.
static Status validate(AppTrainingTask *task, const NetModel_f32 *model, const char *path,
                       AppTrainingScores *scores) {
  const Geo *geo = task->self;
  OverlapModel overlap;
  TRY(write(task, model, "a training in progress", path));
  TRY(app_evaluation_model_open(&overlap, path));
  Status status = STATUS_OK;
  for (int s = 0; s < geo->set_count && !status; s++) status = measure(&overlap, &geo->sets[s], scores);
  overlap_model_destroy(&overlap);
  return status;
}

static Status start(AppTrainingTask *task, NetModel_f32 *model) {
  const Geo *geo = task->self;
  return app_training_start_read(task->config->start, OVERLAP_GEO_NORMALISATION, &geo->pool.whitening, model);
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
