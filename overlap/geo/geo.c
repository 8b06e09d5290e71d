// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/geo.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/coplanar.h"

enum { SIZE = OVERLAP_PAIR_SIZE, HESSIAN_SIZE = SIZE * SIZE };

void overlap_geo_features_onset(const OverlapGeoFeatureSet *set, double *features) {
  GeoMatrix onset;
  GeoSymmetric packed = {{{0}}};
  OverlapGeoInvariants invariants;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES];
  overlap_geo_frame_onset(&onset);
  geo_pack_matrix(&onset, 0, &packed);
  overlap_geo_features_kernel()->features(set, &packed, &invariants, packs);
  geo_unpack_numbers(packs, set->count, 0, features);
}

static Status take_network(OverlapGeoModel *model, const OverlapGeoNetwork *network) {
  model->set = overlap_geo_features_set(network->feature_count);
  if (!model->set)
    return status_fail(
        STATUS_INPUT,
        "the network has %d inputs; expected a number of a pair's features: " OVERLAP_GEO_FEATURE_COUNTS,
        network->feature_count);
  model->network = *network;
  return STATUS_OK;
}

Status overlap_geo_create(OverlapGeoModel *model, const OverlapGeoNetwork *network) {
  *model = (OverlapGeoModel){.kernel = overlap_geo_bundle_kernel(), .offset = log(1.28)};
  if (!network) return STATUS_OK;
  TRY(take_network(model, network));
  double features[OVERLAP_GEO_MAX_FEATURES], value;
  overlap_geo_features_onset(model->set, features);
  TRY(network->eval(network->self, 1, features, &value, NULL));
  if (!isfinite(value))
    return status_fail(STATUS_INPUT, "the network's value at the onset of an overlap is %g", value);
  model->offset -= value;
  return STATUS_OK;
}

Status overlap_geo_create_bound(OverlapGeoModel *model, const OverlapGeoNetwork *network) {
  *model = (OverlapGeoModel){.kernel = overlap_geo_bundle_kernel(), .is_bound = true};
  return take_network(model, network);
}

// The places of pair i's results; NULL where they are not wanted.
typedef struct Place {
  const double *pair;
  double *volume, *gradient, *hessian, *centroid;
  unsigned *flags;
  double *bound; // another network's, of this pair's V
} Place;

static Place place_of(const OverlapBatch *batch, int i) {
  return (Place){.pair = batch->pairs + (size_t)i * SIZE,
                 .volume = batch->volume + i,
                 .gradient = batch->gradient ? batch->gradient + (size_t)i * SIZE : NULL,
                 .hessian = batch->hessian ? batch->hessian + (size_t)i * HESSIAN_SIZE : NULL,
                 .centroid = batch->centroid ? batch->centroid + (size_t)i * 3 : NULL,
                 .flags = batch->flags ? batch->flags + i : NULL};
}

static void write_empty(Place place) {
  *place.volume = 0;
  if (place.gradient) memset(place.gradient, 0, SIZE * sizeof(double));
  if (place.hessian) memset(place.hessian, 0, HESSIAN_SIZE * sizeof(double));
  if (place.centroid) memset(place.centroid, 0, 3 * sizeof(double));
  if (place.flags) *place.flags = OVERLAP_DISJOINT;
}

static Status fall_back(const OverlapGeoModel *model, Place place) {
  unsigned flags;
  double volume;
  if (model->is_bound) {
    write_empty(place);
    return STATUS_OK;
  }
  if (place.hessian)
    TRY(overlap_clip_ops.eval_pair(
        NULL, place.pair, &(OverlapAnswer){.volume = &volume, .hessian = place.hessian, .flags = &flags}));
  TRY(overlap_exact_ops.eval_pair(
      NULL, place.pair,
      &(OverlapAnswer){
          .volume = place.volume, .gradient = place.gradient, .centroid = place.centroid, .flags = &flags}));
  if (place.flags) *place.flags = flags | OVERLAP_FALLBACK;
  return STATUS_OK;
}

// What the gate has no use for: a flat tetrahedron, or one with a coordinate that is not finite.
static Status answer_flat(const OverlapGeoModel *model, Place place) {
  for (int i = 0; i < SIZE; i++)
    if (!isfinite(place.pair[i])) return status_fail(STATUS_INPUT, "a coordinate is not finite");
  return fall_back(model, place);
}

// ρ of a block's columns by a network that takes rows.
static Status eval_rows(const OverlapGeoNetwork *network, OverlapGeoBlock *block, double *value,
                        bool wants_gradient) {
  int size = network->feature_count;
  double rows[OVERLAP_GEO_BLOCK * OVERLAP_GEO_MAX_FEATURES],
      slopes[OVERLAP_GEO_BLOCK * OVERLAP_GEO_MAX_FEATURES];
  for (int at = 0; at < OVERLAP_GEO_BLOCK; at++)
    for (int f = 0; f < size; f++) rows[at * size + f] = block->features[f][at];
  TRY(network->eval(network->self, OVERLAP_GEO_BLOCK, rows, value, wants_gradient ? slopes : NULL));
  for (int at = 0; at < OVERLAP_GEO_BLOCK && wants_gradient; at++)
    for (int f = 0; f < size; f++) block->weights[f][at] = slopes[at * size + f];
  return STATUS_OK;
}

static Status eval_network(const OverlapGeoModel *model, OverlapGeoBlock *block, bool wants_gradient,
                           bool wants_centroid) {
  const OverlapGeoNetwork *network = &model->network;
  if (!network->eval_columns) return eval_rows(network, block, block->outputs[0], wants_gradient);
  int outputs = wants_centroid ? 1 + overlap_geo_features_plane_count(model->set) : 1;
  return network->eval_columns(network->self, block->features[0], outputs, block->outputs[0],
                               wants_gradient ? block->weights[0] : NULL);
}

// Second derivatives of ρ of a block's columns, likewise.
static Status curve_rows(const OverlapGeoNetwork *network, const OverlapGeoBends *bends,
                         OverlapGeoColumn *second) {
  enum { COUNT = OVERLAP_GEO_DIRECTIONS, MOST = OVERLAP_GEO_MAX_FEATURES };
  int size = network->feature_count;
  double rows[MOST], changes[COUNT * MOST], square[COUNT * COUNT];
  for (int at = 0; at < OVERLAP_GEO_BLOCK; at++) {
    for (int f = 0; f < size; f++) {
      rows[f] = bends->features[f][0][at];
      for (int j = 0; j < COUNT; j++) changes[j * size + f] = bends->features[f][1 + j][at];
    }
    TRY(network->curve(network->self, 1, rows, COUNT, changes, square));
    for (int i = 0, pair = 0; i < COUNT; i++)
      for (int j = 0; j <= i; j++, pair++) second[pair][at] = square[i * COUNT + j];
  }
  return STATUS_OK;
}

// Adds the network's part to the curvature.
static Status add_network_curvature(const OverlapGeoNetwork *network, OverlapGeoBends *bends) {
  _Alignas(64) OverlapGeoColumn second[OVERLAP_GEO_DIRECTION_PAIRS];
  if (network->curve_columns)
    TRY(network->curve_columns(network->self, bends->features[0][0], second[0]));
  else
    TRY(curve_rows(network, bends, second));
  for (int pair = 0; pair < OVERLAP_GEO_DIRECTION_PAIRS; pair++)
    for (int at = 0; at < OVERLAP_GEO_BLOCK; at++) bends->curvature[pair][at] += second[pair][at];
  return STATUS_OK;
}

// What lanes could not find a frame of.
static Status answer_unfit(const OverlapGeoModel *model, Place place) {
  OverlapGeoFrame frame;
  if (overlap_geo_frame(&frame, place.pair) != OVERLAP_GEO_EMPTY) return fall_back(model, place);
  write_empty(place);
  return STATUS_OK;
}

static Status blend_column(const OverlapGeoModel *model, const OverlapGeoBundle *bundle, int first,
                           const OverlapGeoBlock *block, int at, Place place) {
  OverlapGeoFrame frame;
  for (int k = 0; k < GEO_LANES; k++) {
    frame.slack[k] = block->slack[k][at];
    for (int c = 0; c < 3; c++) {
      frame.normal.column[c][k] = bundle->normal[c * GEO_LANES + k][first + at];
      frame.scaled.column[c][k] = block->scaled[c * GEO_LANES + k][at];
      frame.basis.column[c][k] = block->basis[c * GEO_LANES + k][at];
    }
    for (int l = 0; l < GEO_LANES; l++) frame.projector.row[k][l] = block->projector[geo_entry(k, l)][at];
  }
  for (int i = 0; i < 32; i++) frame.across[i / 16][i / 4 % 4][i % 4] = bundle->across[i][first + at];
  double own[SIZE], *gradient = place.gradient;
  if (place.hessian && !gradient)
    gradient = memcpy(own, block->gradient[at], sizeof own); // its blend needs it
  if (!model->is_bound)
    return overlap_geo_coplanar_blend(&frame, place.pair, place.volume, gradient, place.hessian,
                                      place.centroid, place.flags);
  overlap_geo_coplanar_fade(&frame, place.volume, gradient, place.hessian);
  return STATUS_OK;
}

// Pairs of a bundle that only want the blend's V and x̄: clipping takes them side by side.
typedef struct Waiting {
  int count;
  double share[OVERLAP_GEO_BUNDLE], pairs[OVERLAP_GEO_BUNDLE * SIZE];
  Place place[OVERLAP_GEO_BUNDLE];
} Waiting;

static void wait_for_clip(const OverlapGeoBlock *block, int at, Place place, Waiting *waiting) {
  GeoMatrix projector;
  OverlapGeoCoplanar coplanar;
  for (int k = 0; k < GEO_LANES; k++)
    for (int l = 0; l < GEO_LANES; l++) projector.row[k][l] = block->projector[geo_entry(k, l)][at];
  overlap_geo_coplanar_find(&projector, &coplanar);
  if (!(coplanar.share > 0)) return;
  memcpy(waiting->pairs + waiting->count * SIZE, place.pair, SIZE * sizeof(double));
  waiting->share[waiting->count] = coplanar.share;
  waiting->place[waiting->count++] = place;
}

static Status blend_waiting(const Waiting *waiting, bool wants_centroid) {
  double volume[OVERLAP_GEO_BUNDLE], centroid[OVERLAP_GEO_BUNDLE * 3];
  if (waiting->count == 0) return STATUS_OK;
  TRY(overlap_clip_ops.eval_batch(NULL, &(OverlapBatch){.pair_count = waiting->count,
                                                        .pairs = waiting->pairs,
                                                        .volume = volume,
                                                        .centroid = wants_centroid ? centroid : NULL}));
  for (int i = 0; i < waiting->count; i++) {
    Place place = waiting->place[i];
    overlap_blend_move(waiting->share[i], volume[i], centroid + 3 * i, place.volume, place.centroid);
    if (place.flags) *place.flags |= OVERLAP_BLENDED;
    if (place.bound) *place.bound *= 1 - OVERLAP_GEO_COPLANAR_FADE * waiting->share[i];
  }
  return STATUS_OK;
}

// The tetrahedron that was moved comes first in bends.
static void write_hessian(const OverlapGeoBends *bends, int at, double *hessian) {
  int moved = bends->is_second[at] > 0;
  for (int i = 0; i < SIZE; i++) {
    const double *row = bends->hessian[at] + SIZE * (moved ? (i + SIZE / 2) % SIZE : i);
    memcpy(hessian + SIZE * i + moved * SIZE / 2, row, SIZE / 2 * sizeof(double));
    memcpy(hessian + SIZE * i + !moved * SIZE / 2, row + SIZE / 2, SIZE / 2 * sizeof(double));
  }
}

// From barycentric coordinates in the first tetrahedron.
static void write_centroid(const OverlapGeoBlock *block, int at, Place place) {
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (int k = 0; k < 4; k++) sum += block->place[k][at] * place.pair[3 * k + c];
    place.centroid[c] = sum;
  }
}

static Status write_column(const OverlapGeoModel *model, const OverlapGeoBundle *bundle, int first,
                           const OverlapGeoBlock *block, const OverlapGeoBends *bends, int at, Place place,
                           Waiting *waiting) {
  *place.volume = block->factor[at];
  if (!(block->is_fit[at] > 0)) return answer_unfit(model, place);
  if (!(*place.volume > 0 && *place.volume < INFINITY)) return fall_back(model, place);
  if (place.gradient) memcpy(place.gradient, block->gradient[at], sizeof block->gradient[at]);
  if (place.hessian) write_hessian(bends, at, place.hessian);
  if (place.centroid) write_centroid(block, at, place);
  if (place.flags) *place.flags = bundle->is_enclosed[first + at] ? OVERLAP_ENCLOSED : 0;
  if (!(block->is_close[at] > 0) || model->is_alone) return STATUS_OK;
  if (place.gradient || place.hessian || model->is_bound)
    return blend_column(model, bundle, first, block, at, place);
  wait_for_clip(block, at, place, waiting);
  return STATUS_OK;
}

// Another network beside the model's, asked for a bound of each V.
typedef struct Beside {
  const OverlapGeoModel *bound; // NULL: none
  double *bounds;               // of the batch's pairs
} Beside;

// To be called before the model's own network, whose output takes the place of this one's.
static Status write_bounds(const Beside *beside, const OverlapGeoBundle *bundle, int first,
                           OverlapGeoBlock *block) {
  TRY(eval_network(beside->bound, block, false, false));
  for (int at = 0; at < OVERLAP_GEO_BLOCK && first + at < bundle->count; at++)
    if (block->is_fit[at] > 0)
      beside->bounds[bundle->pair[first + at]] =
          block->volume[at] * exp(beside->bound->offset + block->outputs[0][at]);
  return STATUS_OK;
}

// V, ∇V, x̄ and ∇²V of a block, as far as they are wanted, in block and bends.
static Status compute_block(const OverlapGeoModel *model, const OverlapBatch *batch, const Beside *beside,
                            OverlapGeoBundle *bundle, int first, OverlapGeoBlock *block,
                            OverlapGeoBends *bends) {
  bool wants_gradient = batch->gradient || batch->hessian;
  model->kernel->frame(bundle, first, block);
  if (model->set) {
    model->kernel->features(model->set, block);
    if (beside->bound) TRY(write_bounds(beside, bundle, first, block));
    TRY(eval_network(model, block, wants_gradient, batch->centroid != NULL));
  } else {
    memset(block->outputs[0], 0, sizeof block->outputs[0]);
  }
  for (int at = 0; at < OVERLAP_GEO_BLOCK; at++)
    block->factor[at] = block->volume[at] * exp(model->offset + block->outputs[0][at]);
  if (wants_gradient) model->kernel->pull(model->set, block);
  if (batch->centroid) model->kernel->centroid(model->set, block);
  if (!batch->hessian) return STATUS_OK;
  model->kernel->bend(model->set, bundle, first, block, bends);
  if (model->set) TRY(add_network_curvature(&model->network, bends));
  model->kernel->finish(model->set != NULL, block, bends);
  return STATUS_OK;
}

// The pairs of the bundle from `first` on.
static Status eval_block(const OverlapGeoModel *model, const OverlapBatch *batch, const Beside *beside,
                         OverlapGeoBundle *bundle, int first, OverlapGeoBlock *block, OverlapGeoBends *bends,
                         Waiting *waiting) {
  TRY(compute_block(model, batch, beside, bundle, first, block, bends));
  for (int at = 0; at < OVERLAP_GEO_BLOCK && first + at < bundle->count; at++) {
    int pair = bundle->pair[first + at];
    Place place = place_of(batch, pair);
    place.bound = beside->bounds ? beside->bounds + pair : NULL;
    TRY(write_column(model, bundle, first, block, bends, at, place, waiting));
  }
  return STATUS_OK;
}

static Status eval_bundle(const OverlapGeoModel *model, const OverlapBatch *batch, const Beside *beside,
                          OverlapGeoBundle *bundle, OverlapGeoBlock *block, OverlapGeoBends *bends) {
  bundle->has_across = batch->gradient || batch->hessian || model->is_bound;
  model->kernel->gate(batch->pair_count, batch->pairs, bundle);
  for (int i = 0; i < batch->pair_count; i++) {
    if (bundle->outcome[i] == OVERLAP_GEO_EMPTY) write_empty(place_of(batch, i));
    if (bundle->outcome[i] == OVERLAP_GEO_UNFIT) TRY(answer_flat(model, place_of(batch, i)));
  }
  Waiting waiting;
  waiting.count = 0;
  for (int first = 0; first < bundle->count; first += OVERLAP_GEO_BLOCK)
    TRY(eval_block(model, batch, beside, bundle, first, block, bends, &waiting));
  return blend_waiting(&waiting, batch->centroid != NULL);
}

static Status eval_bundles(const OverlapGeoModel *model, const OverlapBatch *batch, Beside beside,
                           OverlapGeoBends *bends) {
  OverlapGeoBundle bundle;
  OverlapGeoBlock block;
  for (int begin = 0; begin < batch->pair_count; begin += OVERLAP_GEO_BUNDLE) {
    OverlapBatch part = overlap_ops_part(batch, begin, OVERLAP_GEO_BUNDLE);
    TRY(eval_bundle(model, &part, &beside, &bundle, &block, bends));
    if (beside.bounds) beside.bounds += part.pair_count;
  }
  return STATUS_OK;
}

static Status eval_with_hessians(const OverlapGeoModel *model, const OverlapBatch *batch) {
  OverlapGeoBends bends;
  return eval_bundles(model, batch, (Beside){NULL, NULL}, &bends);
}

Status overlap_geo_eval(const OverlapGeoModel *model, const OverlapBatch *batch) {
  return batch->hessian ? eval_with_hessians(model, batch)
                        : eval_bundles(model, batch, (Beside){NULL, NULL}, NULL);
}

Status overlap_geo_eval_bounded(const OverlapGeoModel *model, const OverlapGeoModel *bound,
                                const OverlapBatch *batch, double *bounds) {
  assert(!batch->hessian && bound->set == model->set);
  memset(bounds, 0, (size_t)batch->pair_count * sizeof *bounds);
  return eval_bundles(model, batch, (Beside){bound, bounds}, NULL);
}

OverlapGeoOutcome overlap_geo_features_tangent(const OverlapGeoFeatureSet *set, const double pair[24],
                                               int count, const double *directions, double *features,
                                               double *feature_changes, double *log_volume,
                                               double *log_volume_changes) {
  const OverlapGeoKernel *kernel = overlap_geo_features_kernel();
  OverlapGeoFrame frame;
  OverlapGeoOutcome outcome = overlap_geo_frame(&frame, pair);
  if (outcome != OVERLAP_GEO_INSIDE) return outcome;
  *log_volume = log(frame.volume);
  GeoSymmetric projector, projector_change;
  OverlapGeoInvariants invariants, change;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES];
  for (int lane = 0; lane < GEO_PACK; lane++) geo_pack_matrix(&frame.projector, lane, &projector);
  kernel->features(set, &projector, &invariants, packs);
  geo_unpack_numbers(packs, set->count, 0, features);
  for (int d = 0; d < count; d++) {
    int lane = d % GEO_PACK;
    if (lane == 0) memset(&projector_change, 0, sizeof projector_change);
    OverlapGeoTangent tangent;
    overlap_geo_frame_push(&frame, directions + (size_t)d * SIZE, &tangent);
    log_volume_changes[d] = tangent.log_volume;
    geo_pack_matrix(&tangent.projector, lane, &projector_change);
    if (lane < GEO_PACK - 1 && d < count - 1) continue;
    kernel->push(set, &invariants, &projector_change, &change, packs);
    for (int l = 0; l <= lane; l++)
      geo_unpack_numbers(packs, set->count, l, feature_changes + (size_t)(d - lane + l) * (size_t)set->count);
  }
  return outcome;
}

OverlapGeoOutcome overlap_geo_features_centroid(const OverlapGeoFeatureSet *set, const double pair[24],
                                                const double centroid[3], double *features, double z[3],
                                                double (*vectors)[3]) {
  const OverlapGeoKernel *kernel = overlap_geo_features_kernel();
  OverlapGeoFrame frame;
  OverlapGeoOutcome outcome = overlap_geo_frame(&frame, pair);
  if (outcome != OVERLAP_GEO_INSIDE) return outcome;
  GeoSymmetric projector = {{{0}}};
  OverlapGeoInvariants invariants;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES], planes[OVERLAP_GEO_MAX_PLANE_FEATURES][GEO_LANES];
  geo_pack_matrix(&frame.projector, 0, &projector);
  kernel->features(set, &projector, &invariants, packs);
  geo_unpack_numbers(packs, set->count, 0, features);
  kernel->planes(set, &invariants, planes);
  double(*q)[GEO_LANES] = frame.basis.column;
  for (int m = 0; m < overlap_geo_features_plane_count(set); m++)
    for (int c = 0; c < 3; c++) {
      vectors[m][c] = 0;
      for (int k = 0; k < GEO_LANES; k++) vectors[m][c] += q[c][k] * planes[m][k][0];
    }
  // q_k·z = m_k·(x̄ − centre), the relative change of s_k
  double change[GEO_LANES];
  for (int k = 0; k < GEO_LANES; k++) {
    const double *base = pair + 3 * ((k & 4) + (k + 1) % 4); // where λ_k is 0
    double along = 0;
    for (int c = 0; c < 3; c++) along += frame.normal.column[c][k] * (centroid[c] - base[c]);
    change[k] = along / frame.slack[k] - 1;
  }
  for (int c = 0; c < 3; c++) z[c] = geo_dot(q[c], change);
  return outcome;
}
