// SPDX-License-Identifier: Apache-2.0
#include "overlap/hybrid/hybrid.h"

#include "base/memory.h"
#include "overlap/hybrid/sure.h"
#include "overlap/tpn/model.h"
#include "overlap/weights.h"

typedef struct Hybrid {
  const OverlapOps *ops; // of the one that it is
  void *self;            // owned
} Hybrid;

static void destroy(void *self) {
  Hybrid *hybrid = self;
  if (!hybrid) return;
  if (hybrid->ops) hybrid->ops->destroy(hybrid->self);
  memory_free(hybrid);
}

static Status make(Hybrid *hybrid, const char *weights, const OverlapOptions *options) {
  char path[4096];
  OverlapWeightsKind kind;
  bool is_path = overlap_weights_is_path(weights);
  if (!is_path) TRY(overlap_weights_find(weights, path, sizeof path));
  TRY(overlap_weights_kind(is_path ? weights : path, &kind));
  const OverlapOps *ops = kind == OVERLAP_WEIGHTS_TPN ? &overlap_tpn_hybrid_ops : &overlap_hybrid_sure_ops;
  TRY(ops->create(&hybrid->self, is_path ? weights : path, options));
  hybrid->ops = ops;
  return STATUS_OK;
}

static Status create(void **self, const char *weights, const OverlapOptions *options) {
  Hybrid *hybrid = memory_zeroed(1, sizeof *hybrid);
  if (!hybrid) return status_no_memory("an overlap model");
  Status status = make(hybrid, weights ? weights : OVERLAP_HYBRID_NETWORK, options);
  if (status)
    destroy(hybrid);
  else
    *self = hybrid;
  return status;
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  const Hybrid *hybrid = self;
  return hybrid->ops->eval_pair(hybrid->self, pair, answer);
}

static Status eval_batch(const void *self, const OverlapBatch *batch) {
  const Hybrid *hybrid = self;
  return hybrid->ops->eval_batch(hybrid->self, batch);
}

static bool has_hessian(const void *self) {
  const Hybrid *hybrid = self;
  return hybrid->ops->has_hessian(hybrid->self);
}

static bool has_centroid(const void *self) {
  const Hybrid *hybrid = self;
  return hybrid->ops->has_centroid && hybrid->ops->has_centroid(hybrid->self);
}

static bool has_bounds(const void *self) {
  return ((const Hybrid *)self)->ops->eval_bounds != NULL;
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  const Hybrid *hybrid = self;
  return hybrid->ops->eval_bounds(hybrid->self, count, pairs, volumes, bounds);
}

static Status eval_slopes(const void *self, int count, const double *pairs, double *slopes) {
  const Hybrid *hybrid = self;
  return hybrid->ops->eval_slopes(hybrid->self, count, pairs, slopes);
}

// One without a centroid of its own has no derivatives by weights, and is not asked.
static size_t weight_count(const void *self) {
  const Hybrid *hybrid = self;
  return hybrid->ops->training->count(hybrid->self);
}

static void read_weights(const void *self, double *parameters) {
  const Hybrid *hybrid = self;
  hybrid->ops->training->read(hybrid->self, parameters);
}

static Status train(const void *self, int count, const double *pairs, const double *by, double *slope) {
  const Hybrid *hybrid = self;
  return hybrid->ops->training->pull(hybrid->self, count, pairs, by, slope);
}

static Status write_weights(const void *self, const double *numbers, const char *path) {
  const Hybrid *hybrid = self;
  return hybrid->ops->training->write(hybrid->self, numbers, path);
}

static const OverlapTraining training = {weight_count, read_weights, train, write_weights};

const OverlapOps overlap_hybrid_ops = {
    .name = "hybrid",
    .help = "learned where a bound of its error is small, clip elsewhere: geo-small unless another is named",
    .has_hessian = has_hessian,
    .has_centroid = has_centroid,
    .has_bounds = has_bounds,
    .seconds_per_pair = 8e-7,
    .create = create,
    .eval_pair = eval_pair,
    .eval_batch = eval_batch,
    .eval_bounds = eval_bounds,
    .eval_slopes = eval_slopes,
    .training = &training,
    .destroy = destroy,
};
