// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/model.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/geo/slopes/slopes.h"
#include "overlap/portions.h"
#include "overlap/weights.h"

static Status load(OverlapGeoOverlap *overlap, const char *path) {
  if (!path) return overlap_geo_create(&overlap->model, NULL);
  TRY(overlap_geo_network_create(&overlap->net, path));
  OverlapGeoNetwork network = overlap_geo_network_interface(overlap->net);
  Status status = overlap_geo_create(&overlap->model, &network);
  return status == STATUS_OK ? STATUS_OK : status_prefix(status, "%s", path);
}

Status overlap_geo_model_create(void **self, const char *path) {
  OverlapGeoOverlap *overlap = memory_zeroed(1, sizeof *overlap);
  if (!overlap) return status_no_memory("an overlap model");
  Status status = load(overlap, path);
  if (status != STATUS_OK) {
    overlap_geo_model_destroy(overlap);
    return status;
  }
  *self = overlap;
  return STATUS_OK;
}

void overlap_geo_model_destroy(void *self) {
  OverlapGeoOverlap *overlap = self;
  if (!overlap) return;
  overlap_geo_network_destroy(overlap->net);
  memory_free(overlap);
}

Status overlap_geo_model_eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch batch = overlap_ops_single(pair, answer);
  const OverlapGeoOverlap *overlap = self;
  return overlap_geo_eval(&overlap->model, &batch);
}

// What one thread takes at a time; the cut does not depend on the number of threads.
enum { PORTION = OVERLAP_GEO_BUNDLE };

static Status eval_portion(const void *model, const OverlapBatch *portion, int first) {
  Status status = overlap_geo_eval(model, portion);
  return status ? status_prefix(status, "pairs %d to %d", first, first + portion->pair_count - 1) : STATUS_OK;
}

Status overlap_geo_model_eval_batch(const void *self, const OverlapBatch *batch) {
  return overlap_portions_eval(batch, PORTION, true, eval_portion, &((const OverlapGeoOverlap *)self)->model);
}

static bool has_centroid(const void *self) {
  return ((const OverlapGeoOverlap *)self)->model.network.has_centroid;
}

static Status eval_slopes(const void *self, int count, const double *pairs, double *slopes) {
  return overlap_geo_slopes_eval(&((const OverlapGeoOverlap *)self)->model, count, pairs, slopes);
}

static size_t weight_count(const void *self) {
  return overlap_geo_network_model(((const OverlapGeoOverlap *)self)->net)->plan->parameter_count;
}

static void read_weights(const void *self, double *parameters) {
  memcpy(parameters, overlap_geo_network_model(((const OverlapGeoOverlap *)self)->net)->parameters,
         weight_count(self) * sizeof *parameters);
}

static Status train(const void *self, int count, const double *pairs, const double *by, double *slope) {
  const OverlapGeoOverlap *overlap = self;
  return overlap_geo_slopes_train(&overlap->model, overlap_geo_network_model(overlap->net), count, pairs, by,
                                  slope);
}

static Status write_weights(const void *self, const double *numbers, const char *path) {
  return overlap_geo_network_write(((const OverlapGeoOverlap *)self)->net, numbers, path);
}

static const OverlapTraining training = {weight_count, read_weights, train, write_weights};

// `weights`: a file, or the name of one that ships; NULL: `own`.
static Status create_named(void **self, const char *own, const char *weights) {
  char path[4096];
  if (!weights) weights = own;
  if (overlap_weights_is_path(weights)) return overlap_geo_model_create(self, weights);
  TRY(overlap_weights_find(weights, path, sizeof path));
  return overlap_geo_model_create(self, path);
}

static Status create_geo(void **self, const char *weights, const OverlapOptions *options) {
  (void)options;
  return create_named(self, "geo", weights);
}

static Status create_geo_small(void **self, const char *weights, const OverlapOptions *options) {
  (void)options;
  return create_named(self, "geo-small", weights);
}

const OverlapOps overlap_geo_ops = {
    .name = "geo",
    .help = "learned: analytic-centre frame and 120 symmetric features; smooth, no ghost forces",
    .has_hessian = overlap_ops_always,
    .has_centroid = has_centroid,
    .checks_finite = true,
    .seconds_per_pair = 1.8e-6,
    .create = create_geo,
    .eval_pair = overlap_geo_model_eval_pair,
    .eval_batch = overlap_geo_model_eval_batch,
    .eval_slopes = eval_slopes,
    .training = &training,
    .destroy = overlap_geo_model_destroy,
};

const OverlapOps overlap_geo_small_ops = {
    .name = "geo-small",
    .help = "learned: as geo, with 56 features and a smaller network",
    .has_hessian = overlap_ops_always,
    .has_centroid = has_centroid,
    .checks_finite = true,
    .seconds_per_pair = 6e-7,
    .create = create_geo_small,
    .eval_pair = overlap_geo_model_eval_pair,
    .eval_batch = overlap_geo_model_eval_batch,
    .eval_slopes = eval_slopes,
    .training = &training,
    .destroy = overlap_geo_model_destroy,
};
