// SPDX-License-Identifier: Apache-2.0
#include "overlap/hybrid/sure.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/geo/model.h"
#include "overlap/geo/slopes/slopes.h"
#include "overlap/hybrid/share.h"
#include "overlap/portions.h"
#include "overlap/weights.h"

enum {
  SIZE = OVERLAP_PAIR_SIZE,
  SQUARE = SIZE * SIZE,
  PORTION = OVERLAP_GEO_BUNDLE, // pairs that a thread takes at once
  BENT = OVERLAP_GEO_BLOCK,     // with derivatives
};

typedef struct Sure {
  OverlapGeoOverlap *geo; // owned
  OverlapGeoNet *net;     // of the bound; owned
  OverlapGeoModel bound;
  double doubt; // t
} Sure;

static void destroy(void *self) {
  Sure *sure = self;
  if (!sure) return;
  overlap_geo_model_destroy(sure->geo);
  overlap_geo_network_destroy(sure->net);
  memory_free(sure);
}

static Status load_bound(Sure *sure, const char *weights) {
  static const char ENDING[] = ".safetensors";
  char path[4096];
  size_t stem = strlen(weights);
  if (stem > strlen(ENDING) && strcmp(weights + stem - strlen(ENDING), ENDING) == 0) stem -= strlen(ENDING);
  int length = snprintf(path, sizeof path, "%.*s-bound%s", (int)stem, weights, ENDING);
  if (length < 0 || (size_t)length >= sizeof path)
    return status_fail(STATUS_INPUT, "%s: the name is too long", weights);
  Status status = overlap_geo_network_create_bound(&sure->net, path);
  if (status)
    return status_prefix(
        status, "hybrid needs a bound of the errors of %s (`tetlap train` with model.kind: bound)", weights);
  OverlapGeoNetwork network = overlap_geo_network_interface(sure->net);
  TRY(overlap_geo_create_bound(&sure->bound, &network));
  if (sure->bound.set != sure->geo->model.set)
    return status_fail(STATUS_INPUT, "%s: has %d features, the network that it is a bound for another number",
                       path, network.feature_count);
  return STATUS_OK;
}

static Status load(Sure *sure, const char *weights) {
  void *geo;
  TRY(overlap_geo_model_create(&geo, weights));
  sure->geo = geo;
  return load_bound(sure, weights);
}

static Status create(void **self, const char *weights, const OverlapOptions *given) {
  OverlapOptions options = given ? *given : overlap_options_default();
  Sure *sure = memory_zeroed(1, sizeof *sure);
  if (!sure) return status_no_memory("an overlap model");
  sure->doubt = options.doubt;
  Status status = load(sure, weights);
  if (status)
    destroy(sure);
  else
    *self = sure;
  return status;
}

static unsigned flags_of(unsigned geo, double share) {
  if (geo & (OVERLAP_DISJOINT | OVERLAP_FLAT | OVERLAP_FALLBACK)) return geo;
  if (share >= 1) return (geo & ~(unsigned)OVERLAP_BLENDED) | OVERLAP_FALLBACK;
  return geo | OVERLAP_NET | (share > 0 ? OVERLAP_BLENDED : 0);
}

// ---- Values.

// Pairs that clipping is asked for, side by side.
typedef struct Waiting {
  int count, at[PORTION];
  double share[PORTION], pairs[PORTION * SIZE];
} Waiting;

static Status mix_waiting(const Waiting *waiting, const OverlapBatch *batch) {
  double volume[PORTION], centroid[3 * PORTION];
  if (waiting->count == 0) return STATUS_OK;
  TRY(overlap_clip_ops.eval_batch(NULL, &(OverlapBatch){.pair_count = waiting->count,
                                                        .pairs = waiting->pairs,
                                                        .volume = volume,
                                                        .centroid = batch->centroid ? centroid : NULL}));
  for (int w = 0; w < waiting->count; w++)
    overlap_blend_move(waiting->share[w], volume[w], centroid + 3 * w, batch->volume + waiting->at[w],
                       batch->centroid ? batch->centroid + 3 * (ptrdiff_t)waiting->at[w] : NULL);
  return STATUS_OK;
}

static Status eval_values(const Sure *sure, const OverlapBatch *batch) {
  double bounds[PORTION];
  unsigned flags[PORTION];
  Waiting waiting;
  waiting.count = 0;
  OverlapBatch own = *batch;
  own.flags = flags;
  TRY(overlap_geo_eval_bounded(&sure->geo->model, &sure->bound, &own, bounds));
  for (int i = 0; i < batch->pair_count; i++) {
    OverlapHybridSigns signs = {.pair = batch->pairs + SIZE * (ptrdiff_t)i,
                                .doubt = sure->doubt,
                                .volume = batch->volume[i],
                                .bound = bounds[i]};
    double share = flags[i] & OVERLAP_FALLBACK ? 0 : overlap_hybrid_share(&signs);
    if (batch->flags) batch->flags[i] = flags_of(flags[i], share);
    if (!(share > 0)) continue;
    memcpy(waiting.pairs + SIZE * waiting.count, signs.pair, SIZE * sizeof(double));
    waiting.share[waiting.count] = share;
    waiting.at[waiting.count++] = i;
  }
  return mix_waiting(&waiting, batch);
}

// ---- With derivatives.

// What both networks say of a few pairs.
typedef struct Told {
  double volume[BENT], gradient[BENT * SIZE];
  double bound[BENT], bound_gradient[BENT * SIZE];
  double hessian[BENT * SQUARE], bound_hessian[BENT * SQUARE];
  unsigned flags[BENT];
} Told;

static OverlapHybridSigns signs_of(const Sure *sure, const OverlapBatch *batch, const Told *told, int i) {
  return (OverlapHybridSigns){.pair = batch->pairs + SIZE * (ptrdiff_t)i,
                              .doubt = sure->doubt,
                              .volume = told->volume[i],
                              .bound = told->flags[i] & OVERLAP_FALLBACK ? 0 : told->bound[i],
                              .volume_gradient = told->gradient + SIZE * i,
                              .bound_gradient = told->bound_gradient + SIZE * i,
                              .volume_hessian = told->hessian + SQUARE * i,
                              .bound_hessian = told->bound_hessian + SQUARE * i};
}

static Status mix_pair(const OverlapBatch *batch, const OverlapHybridSigns *signs, unsigned geo, int i) {
  double *gradient = batch->gradient ? batch->gradient + SIZE * (ptrdiff_t)i : NULL;
  double *hessian = batch->hessian ? batch->hessian + SQUARE * (ptrdiff_t)i : NULL;
  double share_gradient[SIZE], share_hessian[SQUARE];
  double share = overlap_hybrid_share_derive(signs, share_gradient, hessian ? share_hessian : NULL);
  batch->volume[i] = signs->volume;
  if (batch->flags) batch->flags[i] = flags_of(geo, share);
  if (gradient) memcpy(gradient, signs->volume_gradient, SIZE * sizeof(double));
  if (hessian) memcpy(hessian, signs->volume_hessian, SQUARE * sizeof(double));
  if (!(share > 0)) return STATUS_OK;
  double volume, clip_gradient[SIZE], clip_hessian[SQUARE], centroid[3];
  unsigned flags;
  OverlapAnswer clip = {.volume = &volume,
                        .gradient = clip_gradient,
                        .hessian = hessian ? clip_hessian : NULL,
                        .centroid = batch->centroid ? centroid : NULL,
                        .flags = &flags};
  TRY(overlap_clip_ops.eval_pair(NULL, signs->pair, &clip));
  double apart[SIZE];
  for (int k = 0; k < SIZE; k++) apart[k] = clip_gradient[k] - signs->volume_gradient[k];
  overlap_blend_turn(&(OverlapBlendShare){share, share_gradient, share_hessian}, volume - signs->volume,
                     apart, clip_hessian, gradient, hessian);
  overlap_blend_move(share, volume, centroid, batch->volume + i,
                     batch->centroid ? batch->centroid + 3 * (ptrdiff_t)i : NULL);
  return STATUS_OK;
}

static Status eval_bent(const Sure *sure, const OverlapBatch *batch) {
  Told told;
  TRY(overlap_geo_eval(&sure->geo->model, &(OverlapBatch){.pair_count = batch->pair_count,
                                                          .pairs = batch->pairs,
                                                          .volume = told.volume,
                                                          .gradient = told.gradient,
                                                          .hessian = batch->hessian ? told.hessian : NULL,
                                                          .centroid = batch->centroid,
                                                          .flags = told.flags}));
  TRY(overlap_geo_eval(&sure->bound, &(OverlapBatch){.pair_count = batch->pair_count,
                                                     .pairs = batch->pairs,
                                                     .volume = told.bound,
                                                     .gradient = told.bound_gradient,
                                                     .hessian = batch->hessian ? told.bound_hessian : NULL}));
  for (int i = 0; i < batch->pair_count; i++) {
    OverlapHybridSigns signs = signs_of(sure, batch, &told, i);
    TRY(mix_pair(batch, &signs, told.flags[i], i));
  }
  return STATUS_OK;
}

static bool wants_derivatives(const OverlapBatch *batch) {
  return batch->gradient || batch->hessian;
}

static Status eval_portion(const void *self, const OverlapBatch *portion, int first) {
  Status status = wants_derivatives(portion) ? eval_bent(self, portion) : eval_values(self, portion);
  return status ? status_prefix(status, "pairs %d to %d", first, first + portion->pair_count - 1) : STATUS_OK;
}

static Status eval_batch(const void *self, const OverlapBatch *batch) {
  return overlap_portions_eval(batch, wants_derivatives(batch) ? BENT : PORTION, true, eval_portion, self);
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch batch = overlap_ops_single(pair, answer);
  return eval_portion(self, &batch, 0);
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  const Sure *sure = self;
  return overlap_geo_eval_bounded(&sure->geo->model, &sure->bound,
                                  &(OverlapBatch){.pair_count = count, .pairs = pairs, .volume = volumes},
                                  bounds);
}

// ---- Of centroids.

static Status mix_slopes(const Sure *sure, const double *pair, double *slopes) {
  OverlapBlend own, clip;
  double bound, bound_gradient[SIZE], share_gradient[SIZE];
  unsigned flags;
  TRY(overlap_geo_eval(&sure->geo->model, &(OverlapBatch){.pair_count = 1,
                                                          .pairs = pair,
                                                          .volume = &own.volume,
                                                          .gradient = own.gradient,
                                                          .centroid = own.centroid,
                                                          .flags = &flags}));
  TRY(overlap_geo_eval(
      &sure->bound,
      &(OverlapBatch){.pair_count = 1, .pairs = pair, .volume = &bound, .gradient = bound_gradient}));
  TRY(overlap_geo_slopes_eval(&sure->geo->model, 1, pair, own.slopes));
  OverlapHybridSigns signs = {.pair = pair,
                              .doubt = sure->doubt,
                              .volume = own.volume,
                              .bound = flags & OVERLAP_FALLBACK ? 0 : bound,
                              .volume_gradient = own.gradient,
                              .bound_gradient = bound_gradient};
  double share = overlap_hybrid_share_derive(&signs, share_gradient, NULL);
  if (share > 0) {
    TRY(overlap_blend_clip(pair, &clip));
    overlap_blend_mix(share, share_gradient, &clip, &own);
  }
  memcpy(slopes, own.slopes, sizeof own.slopes);
  return STATUS_OK;
}

static Status eval_slopes(const void *self, int count, const double *pairs, double *slopes) {
  for (int i = 0; i < count; i++)
    TRY(mix_slopes(self, pairs + SIZE * (ptrdiff_t)i, slopes + 3 * SIZE * (ptrdiff_t)i));
  return STATUS_OK;
}

// ---- By the weights of V's network; those of the bound are kept.

static size_t weight_count(const void *self) {
  const Sure *sure = self;
  return overlap_geo_ops.training->count(sure->geo);
}

static void read_weights(const void *self, double *parameters) {
  overlap_geo_ops.training->read(((const Sure *)self)->geo, parameters);
}

static Status write_weights(const void *self, const double *numbers, const char *path) {
  return overlap_geo_ops.training->write(((const Sure *)self)->geo, numbers, path);
}

// What g has by the network's V and x̄, given what it has by those of the mixture:
//   V_m = (1 − c) V + c V_clip,   V_m x̄_m = (1 − c) V x̄ + c V_clip x̄_clip,   c a function of V.
static Status unmix(const Sure *sure, const double *pair, const double *by, double *own_by) {
  double own, bound, volume, own_centroid[3], centroid[3], along = 0;
  unsigned flags, clip_flags;
  memcpy(own_by, by, 4 * sizeof *by);
  TRY(overlap_geo_eval_bounded(
      &sure->geo->model, &sure->bound,
      &(OverlapBatch){
          .pair_count = 1, .pairs = pair, .volume = &own, .centroid = own_centroid, .flags = &flags},
      &bound));
  OverlapHybridSigns signs = {.pair = pair, .doubt = sure->doubt, .volume = own, .bound = bound};
  double share = flags & OVERLAP_FALLBACK ? 0 : overlap_hybrid_share(&signs);
  if (!(share > 0)) return STATUS_OK;
  TRY(overlap_clip_ops.eval_pair(
      NULL, pair, &(OverlapAnswer){.volume = &volume, .centroid = centroid, .flags = &clip_flags}));
  double slope = overlap_hybrid_share_by_volume(&signs), mixed = (1 - share) * own + share * volume;
  double factor = 1 - share + slope * (volume - own);
  for (int k = 0; k < 3; k++) {
    double middle = ((1 - share) * own * own_centroid[k] + share * volume * centroid[k]) / mixed;
    along += by[1 + k] * ((1 - share) * own_centroid[k] +
                          slope * (volume * centroid[k] - own * own_centroid[k]) - middle * factor);
    own_by[1 + k] = by[1 + k] * (1 - share) * own / mixed;
  }
  own_by[0] = by[0] * factor + along / mixed;
  return STATUS_OK;
}

static Status train(const void *self, int count, const double *pairs, const double *by, double *slope) {
  const Sure *sure = self;
  double *own_by = memory_zeroed(4 * (size_t)count, sizeof *own_by);
  if (!own_by) return status_no_memory("derivatives by weights");
  Status status = STATUS_OK;
  for (int i = 0; i < count && !status; i++)
    status = unmix(sure, pairs + SIZE * (ptrdiff_t)i, by + 4 * (ptrdiff_t)i, own_by + 4 * (ptrdiff_t)i);
  if (!status) status = overlap_geo_ops.training->pull(sure->geo, count, pairs, own_by, slope);
  memory_free(own_by);
  return status;
}

static const OverlapTraining training = {weight_count, read_weights, train, write_weights};

static bool has_centroid(const void *self) {
  return ((const Sure *)self)->geo->model.network.has_centroid;
}

const OverlapOps overlap_hybrid_sure_ops = {
    .name = "hybrid",
    .help = "a geo where a bound of its error is small, clip elsewhere",
    .has_hessian = overlap_ops_always,
    .has_centroid = has_centroid,
    .seconds_per_pair = 8e-7,
    .create = create,
    .eval_pair = eval_pair,
    .eval_batch = eval_batch,
    .eval_bounds = eval_bounds,
    .eval_slopes = eval_slopes,
    .training = &training,
    .destroy = destroy,
};
