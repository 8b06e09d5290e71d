// SPDX-License-Identifier: GPL-3.0-or-later
// Training of a bound of what a `geo`'s V is off: b(w) against e = ln |V − V*| − ln V₀, V before any blend
// with clip, w the whitened features, by the quantile loss (Koenker, Bassett 1978), and after it the constant
// that makes the share of held-out pairs with |V − V*| ≤ V₀ exp b the one that is asked for
// (overlap/hybrid/sure.h). The validation data hold them.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/geo/fold.h"
#include "app/training/geo/pool.h"
#include "app/training/sets.h"
#include "app/training/task.h"
#include "base/memory.h"
#include "base/sorted.h"
#include "overlap/geo/model.h"
#include "overlap/weights.h"

// Errors below this share of V are rounding, or the answer of another model.
static const double LEAST_ERROR = 1e-9;

// One validation set as the network that is bounded answers it.
typedef struct Held {
  double *volume, *bound; // as the networks give them; (count), owned
} Held;

typedef struct Bound {
  OverlapGeoOverlap *of; // owned
  AppTrainingPool pool;  // its targets are e
  long long unanswered;  // pairs that overlap and that the network leaves to another model
  AppTrainingOrder order;
  AppTrainingSets sets;
  Held held[APP_TRAINING_MAX_SETS];
  double *log_widths, *log_errors; // of all held-out pairs: ln B − ln V, ln |ΔV| − ln B; owned
  double correction;               // what b is moved by
  int *samples;                    // (batch)
  float *x, *y, *gy;               // (batch, features), (batch), (batch)
} Bound;

static NetShape shape(const AppTrainingConfig *config) {
  return net_shape_mlp(config->model.features, config->model.width, config->model.depth, 1);
}

static void destroy(AppTrainingTask *task) {
  Bound *bound = task->self;
  if (!bound) return;
  overlap_geo_model_destroy(bound->of);
  app_training_pool_destroy(&bound->pool);
  app_training_order_destroy(&bound->order);
  app_training_sets_destroy(&bound->sets);
  for (int s = 0; s < APP_TRAINING_MAX_SETS; s++)
    memory_free(bound->held[s].volume), memory_free(bound->held[s].bound);
  memory_free(bound->log_widths), memory_free(bound->log_errors), memory_free(bound->samples);
  memory_free(bound->x), memory_free(bound->y), memory_free(bound->gy), memory_free(bound);
  task->self = NULL;
}

static Status open_network(Bound *bound, const AppTrainingConfig *config) {
  char path[4096];
  const char *name = config->model.of;
  void *of;
  bool is_path = overlap_weights_is_path(name);
  if (!is_path) TRY(overlap_weights_find(name, path, sizeof path));
  TRY(overlap_geo_model_create(&of, is_path ? name : path));
  bound->of = of;
  if (bound->of->model.set == overlap_geo_features_set(config->model.features)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: model.features is %d, '%s' has %d", config->path,
                     config->model.features, name, bound->of->model.set->count);
}

// The errors take the volumes' place; pairs that the network does not answer have none.
static Status find_errors(Bound *bound, DatagenPairs *pairs, size_t count) {
  double *told = memory_zeroed(count, sizeof *told);
  unsigned *flags = memory_zeroed(count, sizeof *flags);
  Status status = told && flags ? STATUS_OK : status_no_memory("the errors of a network");
  OverlapGeoModel alone = bound->of->model;
  alone.is_alone = true;
  if (!status)
    status = overlap_geo_eval(
        &alone, &(OverlapBatch){
                    .pair_count = (int)count, .pairs = pairs->coordinates, .volume = told, .flags = flags});
  for (size_t i = 0; i < count && !status; i++) {
    double volume = pairs->volume[i];
    bool is_answered = volume > 0 && told[i] > 0 && !(flags[i] & OVERLAP_FALLBACK);
    bound->unanswered += volume > 0 && !is_answered;
    pairs->volume[i] = is_answered ? fmax(fabs(told[i] - volume), LEAST_ERROR * volume) : 0;
  }
  memory_free(told), memory_free(flags);
  return status;
}

static Status load_pool(AppTrainingTask *task, const NetWhitening *whitening) {
  Bound *bound = task->self;
  DatagenPairs pairs;
  size_t count;
  TRY(app_training_sets_load_pairs(task->config, &pairs, &count));
  Status status = find_errors(bound, &pairs, count);
  if (!status)
    status = app_training_pool_create(&bound->pool, bound->of->model.set, &pairs, count, whitening);
  datagen_pairs_destroy(&pairs);
  return status;
}

static Status load_sets(AppTrainingTask *task) {
  Bound *bound = task->self;
  size_t all = 0;
  TRY(app_training_sets_load(&bound->sets, task->config));
  for (int s = 0; s < bound->sets.count; s++) {
    Held *held = &bound->held[s];
    held->volume = memory_zeroed(bound->sets.set[s].count, sizeof(double));
    held->bound = memory_zeroed(bound->sets.set[s].count, sizeof(double));
    if (!held->volume || !held->bound) return status_no_memory("the held-out pairs");
    all += bound->sets.set[s].count;
  }
  bound->log_widths = memory_zeroed(all, sizeof(double));
  bound->log_errors = memory_zeroed(all, sizeof(double));
  return bound->log_widths && bound->log_errors ? STATUS_OK : status_no_memory("the held-out pairs");
}

static Status create_batch(Bound *bound, const AppTrainingConfig *config) {
  size_t batch = (size_t)config->optimiser.batch, n = (size_t)config->model.features;
  bound->samples = memory_zeroed(batch, sizeof *bound->samples);
  bound->x = memory_zeroed(batch * n, sizeof(float));
  bound->y = memory_zeroed(batch, sizeof(float));
  bound->gy = memory_zeroed(batch, sizeof(float));
  return bound->samples && bound->x && bound->y && bound->gy ? STATUS_OK : status_no_memory("a batch");
}

static Status create(AppTrainingTask *task, const NetWhitening *whitening) {
  Bound *bound = task->self = memory_zeroed(1, sizeof *bound);
  if (!bound) return status_no_memory("a training");
  TRY(open_network(bound, task->config));
  TRY(load_pool(task, whitening));
  TRY(load_sets(task));
  TRY(app_training_order_create(&bound->order, bound->pool.count));
  int used = snprintf(task->summary, sizeof task->summary, "errors of %s in ", task->config->model.of);
  if (used < (int)sizeof task->summary)
    app_training_pool_describe(&bound->pool, bound->unanswered, task->summary + used,
                               sizeof task->summary - (size_t)used);
  return create_batch(bound, task->config);
}

// The mean of max(τ d, (τ − 1) d), d = e − b; its derivative by b goes to gy.
static double quantile_loss(Bound *bound, const AppTrainingConfig *config) {
  int batch = config->optimiser.batch;
  double share = config->loss.quantile, sum = 0;
  for (int k = 0; k < batch; k++) {
    double above = (double)bound->pool.targets[bound->samples[k]] - (double)bound->y[k];
    double slope = above > 0 ? share : share - 1;
    sum += slope * above;
    bound->gy[k] = (float)(-slope / batch);
  }
  return sum / batch;
}

static double step(AppTrainingTask *task, const NetModel_f32 *model, NetWork_f32 *work, long long number,
                   float *gradient) {
  Bound *bound = task->self;
  const AppTrainingConfig *config = task->config;
  int batch = config->optimiser.batch;
  size_t n = (size_t)bound->pool.set->count;
  app_training_order_take(&bound->order, config->seed, number, batch, bound->samples);
  for (size_t k = 0; k < (size_t)batch; k++)
    memcpy(bound->x + k * n, bound->pool.inputs + (size_t)bound->samples[k] * n, n * sizeof(float));
  net_gradient_forward_f32(work, model, batch, 0, bound->x, NULL, bound->y, NULL);
  double loss = quantile_loss(bound, config);
  net_gradient_backward_f32(work, model, batch, 0, bound->gy, NULL, gradient);
  return loss;
}

static void correct(const void *self, NetModel_f64 *folded) {
  const NetPlan *plan = folded->plan;
  const double correction = ((const Bound *)self)->correction;
  folded->parameters[plan->tensors[plan->tensor_count - 1].offset] += correction; // the last bias
}

static Status write(const AppTrainingTask *task, const NetModel_f32 *model, const char *provenance,
                    const char *path) {
  const Bound *bound = task->self;
  char range[256], normalisation[] = OVERLAP_GEO_BOUND_NORMALISATION;
  snprintf(range, sizeof range,
           "of held-out pairs as those of the training, %.15g %% have an error of V below V0 exp b",
           100 * task->config->loss.quantile);
  AppTrainingFold fold = {.model = model,
                          .whitening = &bound->pool.whitening,
                          .normalisation = normalisation,
                          .range = range,
                          .provenance = provenance,
                          .finish = correct,
                          .self = bound};
  return app_training_fold_write(&fold, path);
}

// V and bound of all held-out pairs, by both networks.
static Status evaluate_networks(const Bound *bound, const char *path) {
  OverlapGeoNet *net;
  TRY(overlap_geo_network_create_bound(&net, path));
  OverlapGeoNetwork network = overlap_geo_network_interface(net);
  OverlapGeoModel model;
  Status status = overlap_geo_create_bound(&model, &network);
  for (int s = 0; s < bound->sets.count && !status; s++) {
    const AppTrainingSet *set = &bound->sets.set[s];
    OverlapBatch batch = {
        .pair_count = (int)set->count, .pairs = set->pairs.coordinates, .volume = bound->held[s].volume};
    status = overlap_geo_eval_bounded(&bound->of->model, &model, &batch, bound->held[s].bound);
  }
  overlap_geo_network_destroy(net);
  return status;
}

static size_t gather(const Bound *bound) {
  size_t count = 0;
  for (int s = 0; s < bound->sets.count; s++) {
    const AppTrainingSet *set = &bound->sets.set[s];
    for (size_t i = 0; i < set->count; i++) {
      double truth = set->pairs.volume[i], found = bound->held[s].volume[i], width = bound->held[s].bound[i];
      if (!(truth > 0 && found > 0 && width > 0)) continue;
      bound->log_widths[count] = log(width / found);
      bound->log_errors[count++] = log(fmax(fabs(found - truth), LEAST_ERROR * truth) / width);
    }
  }
  return count;
}

// The constant is the ⌈(n + 1) τ⌉-th smallest of n; the score, the mean of ln B/V with it.
static Status validate(AppTrainingTask *task, const NetModel_f32 *model, const char *path,
                       AppTrainingScores *scores) {
  Bound *bound = task->self;
  bound->correction = 0;
  TRY(write(task, model, "a training in progress", path));
  TRY(evaluate_networks(bound, path));
  size_t count = gather(bound), place = (size_t)ceil((double)(count + 1) * task->config->loss.quantile);
  if (place > count || count == 0)
    return status_fail(STATUS_INPUT, "%s: %zu held-out pairs with volume are too few for a share of %g",
                       task->config->path, count, task->config->loss.quantile);
  sorted_values(bound->log_errors, count);
  sorted_values(bound->log_widths, count);
  bound->correction = bound->log_errors[place - 1];
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += bound->log_widths[i];
  app_training_scores_add(scores, "held", "correction", bound->correction);
  app_training_scores_add(scores, "held", "width_median",
                          exp(bound->log_widths[count / 2] + bound->correction));
  scores->score = sum / (double)count + bound->correction;
  return STATUS_OK;
}

static Status start(AppTrainingTask *task, NetModel_f32 *model) {
  (void)model;
  return status_fail(STATUS_INPUT, "%s: `start` is for networks that predict V", task->config->path);
}

static const NetWhitening *whitening_of(const AppTrainingTask *task) {
  return &((const Bound *)task->self)->pool.whitening;
}

const AppTrainingTaskOps app_training_bound = {
    .shape = shape,
    .create = create,
    .start = start,
    .step = step,
    .validate = validate,
    .write = write,
    .whitening = whitening_of,
    .destroy = destroy,
};
