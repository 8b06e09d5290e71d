// SPDX-License-Identifier: Apache-2.0
#include "overlap/hybrid/sure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/clip/clip.h"
#include "overlap/geo/coplanar.h"
#include "overlap/geo/model.h"
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

// c and its derivatives by u = ln(B/V).
typedef struct Share {
  double value, slope, bend;
} Share;

static Share share_of(const Sure *sure, double bound, double volume) {
  if (!(bound > 0 && volume > 0)) return (Share){0, 0, 0};
  double rate = 1 / log(2), x = rate * log(bound / (sure->doubt * volume));
  if (x >= 1) return (Share){1, 0, 0};
  if (!(x > 0)) return (Share){0, 0, 0};
  return (Share){x * x * (3 - 2 * x), 6 * x * (1 - x) * rate, 6 * (1 - 2 * x) * rate * rate};
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
    overlap_geo_coplanar_mix(waiting->share[w], volume[w], centroid + 3 * w, batch->volume + waiting->at[w],
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
    double share = flags[i] & OVERLAP_FALLBACK ? 0 : share_of(sure, bounds[i], batch->volume[i]).value;
    if (batch->flags) batch->flags[i] = flags_of(flags[i], share);
    if (!(share > 0)) continue;
    memcpy(waiting.pairs + SIZE * waiting.count, batch->pairs + SIZE * (ptrdiff_t)i, SIZE * sizeof(double));
    waiting.share[waiting.count] = share;
    waiting.at[waiting.count++] = i;
  }
  return mix_waiting(&waiting, batch);
}

// ---- With derivatives.

// The parts of one pair's answer; gradients, and Hessians unless NULL.
typedef struct Parts {
  double net, clip, bound;
  const double *net_gradient, *clip_gradient, *bound_gradient;
  const double *net_hessian, *clip_hessian, *bound_hessian;
} Parts;

// ∇c and, unless NULL, ∇²c: of c(u), u = ln B − ln V.
static void differentiate_share(const Parts *parts, Share share, double gradient[SIZE], double *hessian) {
  double by_bound[SIZE], by_net[SIZE], change[SIZE];
  for (int i = 0; i < SIZE; i++) {
    by_bound[i] = parts->bound_gradient[i] / parts->bound;
    by_net[i] = parts->net_gradient[i] / parts->net;
    change[i] = by_bound[i] - by_net[i];
    gradient[i] = share.slope * change[i];
  }
  for (int i = 0; i < SIZE && hessian; i++)
    for (int j = 0; j < SIZE; j++)
      hessian[SIZE * i + j] =
          share.bend * change[i] * change[j] +
          share.slope * (parts->bound_hessian[SIZE * i + j] / parts->bound - by_bound[i] * by_bound[j] -
                         parts->net_hessian[SIZE * i + j] / parts->net + by_net[i] * by_net[j]);
}

// ∇V = (1 − c) ∇V_net + c ∇V_clip + (V_clip − V_net) ∇c, and ∇²V.
static void mix_derivatives(const Parts *parts, Share share, double *gradient, double *hessian) {
  double share_gradient[SIZE], share_hessian[SQUARE], apart[SIZE], difference = parts->clip - parts->net;
  differentiate_share(parts, share, share_gradient, hessian ? share_hessian : NULL);
  for (int i = 0; i < SIZE; i++) apart[i] = parts->clip_gradient[i] - parts->net_gradient[i];
  for (int i = 0; i < SIZE && hessian; i++)
    for (int j = i; j < SIZE; j++) {
      int at = SIZE * i + j;
      hessian[at] =
          parts->net_hessian[at] + share.value * (parts->clip_hessian[at] - parts->net_hessian[at]) +
          share_gradient[i] * apart[j] + apart[i] * share_gradient[j] + difference * share_hessian[at];
      hessian[SIZE * j + i] = hessian[at];
    }
  for (int i = 0; i < SIZE && gradient; i++)
    gradient[i] = parts->net_gradient[i] + share.value * apart[i] + difference * share_gradient[i];
}

// What both networks say of a few pairs.
typedef struct Told {
  double volume[BENT], gradient[BENT * SIZE];
  double bound[BENT], bound_gradient[BENT * SIZE];
  double hessian[BENT * SQUARE], bound_hessian[BENT * SQUARE];
  unsigned flags[BENT];
} Told;

static Status mix_pair(const Sure *sure, const OverlapBatch *batch, const Told *told, int i) {
  const double *pair = batch->pairs + SIZE * (ptrdiff_t)i;
  double *gradient = batch->gradient ? batch->gradient + SIZE * (ptrdiff_t)i : NULL;
  double *hessian = batch->hessian ? batch->hessian + SQUARE * (ptrdiff_t)i : NULL;
  Share share = {0, 0, 0};
  if (!(told->flags[i] & OVERLAP_FALLBACK)) share = share_of(sure, told->bound[i], told->volume[i]);
  batch->volume[i] = told->volume[i];
  if (batch->flags) batch->flags[i] = flags_of(told->flags[i], share.value);
  if (gradient) memcpy(gradient, told->gradient + SIZE * i, SIZE * sizeof(double));
  if (hessian) memcpy(hessian, told->hessian + SQUARE * i, SQUARE * sizeof(double));
  if (!(share.value > 0)) return STATUS_OK;
  double volume, clip_gradient[SIZE], clip_hessian[SQUARE], centroid[3];
  unsigned flags;
  TRY(overlap_clip_ops.eval_pair(NULL, pair,
                                 &(OverlapAnswer){.volume = &volume,
                                                  .gradient = clip_gradient,
                                                  .hessian = hessian ? clip_hessian : NULL,
                                                  .centroid = batch->centroid ? centroid : NULL,
                                                  .flags = &flags}));
  Parts parts = {.net = told->volume[i],
                 .clip = volume,
                 .bound = told->bound[i],
                 .net_gradient = told->gradient + SIZE * i,
                 .clip_gradient = clip_gradient,
                 .bound_gradient = told->bound_gradient + SIZE * i,
                 .net_hessian = told->hessian + SQUARE * i,
                 .clip_hessian = clip_hessian,
                 .bound_hessian = told->bound_hessian + SQUARE * i};
  mix_derivatives(&parts, share, gradient, hessian);
  overlap_geo_coplanar_mix(share.value, volume, centroid, batch->volume + i,
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
  for (int i = 0; i < batch->pair_count; i++) TRY(mix_pair(sure, batch, &told, i));
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
    .destroy = destroy,
};
