// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/slopes/slopes.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "net/pass/gradient.h"
#include "net/work.h"
#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/geo/coplanar.h"

enum { SIZE = OVERLAP_PAIR_SIZE, ROWS = 3 * SIZE, MOST_PLANES = OVERLAP_GEO_MAX_PLANE_FEATURES };

// One pair on its way to x̄.
typedef struct Way {
  const double *pair;
  OverlapGeoFrame frame;
  int plane_count;
  GeoSymmetric projector;
  OverlapGeoInvariants invariants;
  GeoPack planes[MOST_PLANES][GEO_LANES]; // e
  double features[OVERLAP_GEO_MAX_FEATURES];
  double outputs[1 + MOST_PLANES]; // ρ, c
  double weight[GEO_LANES];        // α
  double change[GEO_LANES];        // P α
  double scale;                    // σ
  int lowest;                      // the plane by which σ is below 1; −1: none
  // ∂x̄/∂ of a component by P α and by α, and by the features at fixed e.
  double by_change[3][GEO_LANES], by_weight[3][GEO_LANES];
  double by_features[3][OVERLAP_GEO_MAX_FEATURES];
} Way;

static void project(const OverlapGeoFrame *frame, const double x[GEO_LANES], double y[GEO_LANES]) {
  for (int k = 0; k < GEO_LANES; k++) y[k] = geo_dot(frame->projector.row[k], x);
}

static void shift_slacks(Way *way) {
  project(&way->frame, way->weight, way->change);
  double most = OVERLAP_GEO_LONGEST_SHIFT, least = -most;
  way->scale = 1;
  way->lowest = -1;
  for (int k = 0; k < GEO_LANES; k++)
    if (way->change[k] < least) least = way->change[k], way->lowest = k;
  if (way->lowest >= 0) way->scale = most / -least;
}

// By P α, where the first tetrahedron's planes alone say where x̄ is.
static void pull_places(Way *way) {
  for (int c = 0; c < 3; c++) {
    double along = 0;
    memset(way->by_change[c], 0, sizeof way->by_change[c]);
    for (int k = 0; k < 4; k++) {
      double arm = way->frame.slack[k] * way->pair[3 * k + c];
      way->by_change[c][k] = way->scale * arm;
      along += way->change[k] * arm;
    }
    if (way->lowest >= 0) way->by_change[c][way->lowest] -= along * way->scale / way->change[way->lowest];
    project(&way->frame, way->by_change[c], way->by_weight[c]);
  }
}

static Status pull_network(const OverlapGeoModel *model, Way *way) {
  const OverlapGeoNetwork *network = &model->network;
  int outputs = 1 + way->plane_count, features = network->feature_count;
  double seeds[3 * (1 + MOST_PLANES)] = {0}, slopes[3 * OVERLAP_GEO_MAX_FEATURES];
  for (int c = 0; c < 3; c++)
    for (int m = 0; m < way->plane_count; m++)
      for (int k = 0; k < GEO_LANES; k++)
        seeds[outputs * c + 1 + m] += way->by_weight[c][k] * way->planes[m][k][0];
  TRY(network->pull(network->self, way->features, 3, seeds, way->outputs, slopes));
  for (int c = 0; c < 3; c++)
    memcpy(way->by_features[c], slopes + features * c, (size_t)features * sizeof *slopes);
  return STATUS_OK;
}

// Forward to x̄ and back to the features.
static Status find_way(const OverlapGeoModel *model, Way *way) {
  const OverlapGeoKernel *kernel = overlap_geo_features_kernel();
  const OverlapGeoNetwork *network = &model->network;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES];
  for (int lane = 0; lane < GEO_PACK; lane++) geo_pack_matrix(&way->frame.projector, lane, &way->projector);
  kernel->features(model->set, &way->projector, &way->invariants, packs);
  geo_unpack_numbers(packs, model->set->count, 0, way->features);
  kernel->planes(model->set, &way->invariants, way->planes);
  way->plane_count = overlap_geo_features_plane_count(model->set);
  TRY(network->pull(network->self, way->features, 0, NULL, way->outputs, NULL));
  memset(way->weight, 0, sizeof way->weight);
  for (int m = 0; m < way->plane_count; m++)
    for (int k = 0; k < GEO_LANES; k++) way->weight[k] += way->outputs[1 + m] * way->planes[m][k][0];
  shift_slacks(way);
  pull_places(way);
  return pull_network(model, way);
}

// The change of x̄ along a direction, whose changes of features and planes stand in a lane.
static void push_lane(const Way *way, int feature_count, const OverlapGeoTangent *tangent,
                      const GeoPack *features, GeoPack (*planes)[GEO_LANES], int lane, double change[3]) {
  double weight[GEO_LANES] = {0};
  for (int m = 0; m < way->plane_count; m++)
    for (int k = 0; k < GEO_LANES; k++) weight[k] += way->outputs[1 + m] * planes[m][k][lane];
  for (int c = 0; c < 3; c++) {
    double sum = geo_dot(way->by_weight[c], weight);
    for (int k = 0; k < 4; k++)
      sum +=
          tangent->rate[k] * way->frame.slack[k] * (1 + way->scale * way->change[k]) * way->pair[3 * k + c];
    for (int k = 0; k < GEO_LANES; k++)
      sum += way->by_change[c][k] * geo_dot(tangent->projector.row[k], way->weight);
    for (int f = 0; f < feature_count; f++) sum += way->by_features[c][f] * features[f][lane];
    change[c] = sum;
  }
}

// x̄ goes with the first tetrahedron's vertices by its places there.
static void add_places(const Way *way, double slopes[ROWS]) {
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++)
      slopes[SIZE * c + 3 * k + c] += way->frame.slack[k] * (1 + way->scale * way->change[k]);
}

static void push_all(const OverlapGeoModel *model, const Way *way, double slopes[ROWS]) {
  const OverlapGeoKernel *kernel = overlap_geo_features_kernel();
  OverlapGeoTangent tangents[GEO_PACK];
  OverlapGeoInvariants change;
  GeoSymmetric projector;
  GeoPack features[OVERLAP_GEO_MAX_FEATURES], planes[MOST_PLANES][GEO_LANES];
  for (int first = 0; first < SIZE; first += GEO_PACK) {
    for (int lane = 0; lane < GEO_PACK; lane++) {
      double direction[SIZE] = {0};
      direction[first + lane] = 1;
      overlap_geo_frame_push(&way->frame, direction, &tangents[lane]);
      geo_pack_matrix(&tangents[lane].projector, lane, &projector);
    }
    kernel->push(model->set, &way->invariants, &projector, &change, features);
    kernel->push_planes(model->set, &way->invariants, &change, planes);
    for (int lane = 0; lane < GEO_PACK; lane++) {
      double moved[3];
      push_lane(way, model->set->count, &tangents[lane], features, planes, lane, moved);
      for (int c = 0; c < 3; c++) slopes[SIZE * c + first + lane] = moved[c];
    }
  }
  add_places(way, slopes);
}

// What clipping has a share in.
static Status blend(const OverlapGeoFrame *frame, const double pair[24], OverlapBlend *to) {
  OverlapGeoCoplanar coplanar;
  OverlapBlend clip;
  double share_gradient[SIZE];
  overlap_geo_coplanar_find(&frame->projector, &coplanar);
  if (!(coplanar.share > 0)) return STATUS_OK;
  overlap_geo_coplanar_pull(frame, &coplanar, share_gradient, NULL);
  TRY(overlap_blend_clip(pair, &clip));
  overlap_blend_mix(coplanar.share, share_gradient, &clip, to);
  return STATUS_OK;
}

// V, ∇V, x̄ of the network alone, and its frame; false: clipping answers, or nothing is there.
static Status find_alone(const OverlapGeoModel *model, const double pair[24], OverlapGeoFrame *frame,
                         OverlapBlend *own, bool *is_clipped, bool *is_own) {
  OverlapGeoModel alone = *model;
  unsigned flags;
  alone.is_alone = true;
  TRY(overlap_geo_eval(&alone, &(OverlapBatch){.pair_count = 1,
                                               .pairs = pair,
                                               .volume = &own->volume,
                                               .gradient = own->gradient,
                                               .centroid = own->centroid,
                                               .flags = &flags}));
  *is_clipped = flags & OVERLAP_FALLBACK;
  *is_own = !*is_clipped && own->volume > 0;
  if (*is_own && overlap_geo_frame(frame, pair) != OVERLAP_GEO_INSIDE) *is_own = false, *is_clipped = true;
  return STATUS_OK;
}

static Status eval_pair(const OverlapGeoModel *model, const double pair[24], double slopes[ROWS]) {
  Way way = {.pair = pair};
  OverlapBlend own;
  bool is_clipped, is_own;
  memset(slopes, 0, ROWS * sizeof *slopes);
  TRY(find_alone(model, pair, &way.frame, &own, &is_clipped, &is_own));
  if (!is_clipped && !is_own) return STATUS_OK;
  if (is_clipped) {
    TRY(overlap_blend_clip(pair, &own));
  } else {
    TRY(find_way(model, &way));
    push_all(model, &way, own.slopes);
    if (!model->is_alone) TRY(blend(&way.frame, pair, &own));
  }
  memcpy(slopes, own.slopes, sizeof own.slopes);
  return STATUS_OK;
}

Status overlap_geo_slopes_eval(const OverlapGeoModel *model, int count, const double *pairs, double *slopes) {
  for (int i = 0; i < count; i++) TRY(eval_pair(model, pairs + SIZE * (size_t)i, slopes + ROWS * (size_t)i));
  return STATUS_OK;
}

// ---- By the network's parameters.

// From V and x̄ of the blend to those of the network, of whose V clipping's share w leaves 1 − w.
static Status unblend(const OverlapGeoFrame *frame, const double pair[24], const OverlapBlend *own,
                      double by[4]) {
  OverlapGeoCoplanar coplanar;
  double volume, centroid[3], along = 0;
  unsigned flags;
  overlap_geo_coplanar_find(&frame->projector, &coplanar);
  if (!(coplanar.share > 0)) return STATUS_OK;
  TRY(overlap_clip_ops.eval_pair(NULL, pair,
                                 &(OverlapAnswer){.volume = &volume, .centroid = centroid, .flags = &flags}));
  double left = 1 - coplanar.share, mixed = left * own->volume + coplanar.share * volume,
         part = mixed > 0 ? coplanar.share * volume / mixed : 0;
  for (int c = 0; c < 3; c++) along += by[1 + c] * (centroid[c] - own->centroid[c]);
  by[0] = mixed > 0 ? left * (by[0] - part / mixed * along) : 0;
  for (int c = 0; c < 3; c++) by[1 + c] *= 1 - part;
  return STATUS_OK;
}

// Rows of a network's inputs, and what g has by its outputs there.
typedef struct Rows {
  int count, inputs, outputs;
  double *features, *seeds, *values; // (count, inputs), (count, outputs), the same
} Rows;

static void add_row(Rows *rows, const double *features, double by_rho, const double *by_coefficients) {
  double *seed = rows->seeds + (size_t)rows->outputs * (size_t)rows->count;
  memcpy(rows->features + (size_t)rows->inputs * (size_t)rows->count, features,
         (size_t)rows->inputs * sizeof *features);
  memset(seed, 0, (size_t)rows->outputs * sizeof *seed);
  seed[0] = by_rho;
  if (by_coefficients) memcpy(seed + 1, by_coefficients, (size_t)(rows->outputs - 1) * sizeof *seed);
  rows->count++;
}

// Adds to `*by_rho` the row's ∂g/∂ρ.
static Status add_pair(const OverlapGeoModel *model, const double pair[24], const double given[4], Rows *rows,
                       double *by_rho) {
  Way way = {.pair = pair};
  OverlapBlend own;
  bool is_clipped, is_own;
  double by[4] = {given[0], given[1], given[2], given[3]}, coefficients[MOST_PLANES] = {0};
  TRY(find_alone(model, pair, &way.frame, &own, &is_clipped, &is_own));
  if (!is_own) return STATUS_OK;
  if (!model->is_alone) TRY(unblend(&way.frame, pair, &own, by));
  TRY(find_way(model, &way));
  for (int m = 0; m < way.plane_count; m++)
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < GEO_LANES; k++)
        coefficients[m] += by[1 + c] * way.by_weight[c][k] * way.planes[m][k][0];
  add_row(rows, way.features, by[0] * own.volume, coefficients);
  *by_rho += by[0] * own.volume;
  return STATUS_OK;
}

static Status list_rows(const OverlapGeoModel *model, int count, const double *pairs, const double *by,
                        Rows *rows) {
  double onset[OVERLAP_GEO_MAX_FEATURES], by_rho = 0;
  for (int i = 0; i < count; i++)
    TRY(add_pair(model, pairs + SIZE * (size_t)i, by + 4 * (size_t)i, rows, &by_rho));
  overlap_geo_features_onset(model->set, onset);
  add_row(rows, onset, -by_rho, NULL);
  return STATUS_OK;
}

static Status pull_rows(const NetModel_f64 *net, const Rows *rows, double *slope) {
  NetWork_f64 work = {0};
  NetWorkDef def = net_work_default();
  size_t size = net->plan->parameter_count;
  double *own = memory_zeroed(size, sizeof *own);
  def.batch = rows->count;
  bool fits = own && net_work_create_f64(net->plan, &def, &work) == NET_OK;
  if (fits) {
    net_gradient_forward_f64(&work, net, rows->count, 0, rows->features, NULL, rows->values, NULL);
    net_gradient_backward_f64(&work, net, rows->count, 0, rows->seeds, NULL, own);
    for (size_t i = 0; i < size; i++) slope[i] += own[i];
  }
  net_work_destroy_f64(&work);
  memory_free(own);
  return fits ? STATUS_OK : status_no_memory("derivatives by weights");
}

Status overlap_geo_slopes_train(const OverlapGeoModel *model, const NetModel_f64 *net, int count,
                                const double *pairs, const double *by, double *slope) {
  Rows rows = {.inputs = net->plan->shape.input_count, .outputs = net->plan->shape.output_count};
  size_t most = (size_t)count + 1, width = (size_t)(rows.inputs + 2 * rows.outputs);
  rows.features = memory_zeroed(most * width, sizeof *rows.features);
  if (!rows.features) return status_no_memory("derivatives by weights");
  rows.seeds = rows.features + most * (size_t)rows.inputs;
  rows.values = rows.seeds + most * (size_t)rows.outputs;
  Status status = list_rows(model, count, pairs, by, &rows);
  if (!status) status = pull_rows(net, &rows, slope);
  memory_free(rows.features);
  return status;
}
