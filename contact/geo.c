// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo.h"

#include <math.h>
#include <string.h>

#include "contact/clip.h"
#include "contact/exact.h"
#include "contact/geo_coplanar.h"
#include "contact/geo_hessian.h"

enum { SIZE = CONTACT_PAIR_SIZE, HESSIAN_SIZE = SIZE * SIZE };

// Of one P: in a pack of its own.
static void find_features(const ContactGeoModel *model, const GeoMatrix *projector, double *features) {
  GeoSymmetric packed = {{{0}}};
  ContactGeoInvariants invariants;
  GeoPack packs[CONTACT_GEO_MAX_FEATURES];
  geo_pack_matrix(projector, 0, &packed);
  model->kernel->features(model->set, &packed, &invariants, packs);
  geo_unpack_numbers(packs, model->set->count, 0, features);
}

Status contact_geo_model_create(ContactGeoModel *model, const ContactGeoNetwork *network) {
  *model = (ContactGeoModel){
      .kernel = contact_geo_kernel(), .bundle_kernel = contact_geo_bundle_kernel(), .offset = log(1.28)};
  if (!network) return STATUS_OK;
  model->set = contact_geo_feature_set(network->feature_count);
  if (!model->set)
    return status_fail(STATUS_INPUT, "the network has %d inputs: the features of a pair are 36, 70 or 100",
                       network->feature_count);
  model->network = *network;
  GeoMatrix onset;
  double features[CONTACT_GEO_MAX_FEATURES], value;
  contact_geo_onset(&onset);
  find_features(model, &onset, features);
  TRY(network->eval(network->self, 1, features, &value, NULL));
  if (!isfinite(value))
    return status_fail(STATUS_INPUT, "the network's value at the onset of an overlap is %g", value);
  model->offset -= value;
  return STATUS_OK;
}

enum { PACKS = CONTACT_GEO_CHUNK / GEO_PACK };

// The pairs of a chunk that have a frame, and what is known of them.
typedef struct Chunk {
  int count;
  int pair[CONTACT_GEO_CHUNK]; // index in the batch
  ContactGeoFrame frame[CONTACT_GEO_CHUNK];
  ContactGeoInvariants invariants[PACKS];
  double features[CONTACT_GEO_CHUNK * CONTACT_GEO_MAX_FEATURES]; // (count, set->count)
  double value[CONTACT_GEO_CHUNK];                               // ρ
  GeoMatrix slope[CONTACT_GEO_CHUNK];                            // Φ
  ContactGeoAdjoint adjoint[CONTACT_GEO_CHUNK];
  bool is_abandoned[CONTACT_GEO_CHUNK];                         // answered by the exact model
  double weights[CONTACT_GEO_CHUNK * CONTACT_GEO_MAX_FEATURES]; // dρ/df (count, set->count)
} Chunk;

// How many pairs are in pack `pack` of the chunk.
static int lanes_of(const Chunk *chunk, int pack) {
  int left = chunk->count - pack * GEO_PACK;
  return left < GEO_PACK ? left : GEO_PACK;
}

// The places of pair i's results; NULL where they are not wanted.
typedef struct Place {
  const double *pair;
  double *volume, *gradient, *hessian;
  unsigned *flags;
} Place;

static Place place_of(const ContactOverlapBatch *batch, int i) {
  return (Place){.pair = batch->pairs + (size_t)i * SIZE,
                 .volume = batch->volume + i,
                 .gradient = batch->gradient ? batch->gradient + (size_t)i * SIZE : NULL,
                 .hessian = batch->hessian ? batch->hessian + (size_t)i * HESSIAN_SIZE : NULL,
                 .flags = batch->flags ? batch->flags + i : NULL};
}

static void write_empty(Place place) {
  *place.volume = 0;
  if (place.gradient) memset(place.gradient, 0, SIZE * sizeof(double));
  if (place.hessian) memset(place.hessian, 0, HESSIAN_SIZE * sizeof(double));
  if (place.flags) *place.flags = CONTACT_OVERLAP_DISJOINT;
}

static Status fall_back(Place place) {
  unsigned flags;
  double volume;
  if (place.hessian)
    TRY(contact_overlap_clip.eval_pair(NULL, place.pair, &volume, NULL, place.hessian, &flags));
  TRY(contact_overlap_exact.eval_pair(NULL, place.pair, place.volume, place.gradient, NULL, &flags));
  if (place.flags) *place.flags = flags | CONTACT_OVERLAP_FALLBACK;
  return STATUS_OK;
}

static Status find_frames(const ContactOverlapBatch *batch, int begin, int end, Chunk *chunk) {
  chunk->count = 0;
  for (int i = begin; i < end; i++) {
    Place place = place_of(batch, i);
    ContactGeoFrame *frame = &chunk->frame[chunk->count];
    switch (contact_geo_frame(frame, place.pair)) {
    case CONTACT_GEO_EMPTY:
      write_empty(place);
      continue;
    case CONTACT_GEO_UNFIT:
      TRY(fall_back(place));
      continue;
    case CONTACT_GEO_INSIDE:
      break;
    }
    chunk->pair[chunk->count++] = i;
  }
  return STATUS_OK;
}

static void fill_features(const ContactGeoModel *model, Chunk *chunk) {
  int size = model->set->count;
  for (int pack = 0; pack * GEO_PACK < chunk->count; pack++) {
    GeoSymmetric projector = {{{0}}};
    GeoPack features[CONTACT_GEO_MAX_FEATURES];
    for (int lane = 0; lane < lanes_of(chunk, pack); lane++)
      geo_pack_matrix(&chunk->frame[pack * GEO_PACK + lane].projector, lane, &projector);
    model->kernel->features(model->set, &projector, &chunk->invariants[pack], features);
    for (int lane = 0; lane < lanes_of(chunk, pack); lane++)
      geo_unpack_numbers(features, size, lane, chunk->features + (pack * GEO_PACK + lane) * size);
  }
}

// From one backward sweep of a pack: Φ and ∂ log V/∂x of its pairs.
static void sweep_pack(const ContactGeoModel *model, Chunk *chunk, int pack) {
  int size = model->set ? model->set->count : 0;
  GeoSymmetric slopes = {{{0}}};
  if (model->set) {
    ContactGeoSweep sweep;
    GeoPack weights[CONTACT_GEO_MAX_FEATURES] = {{0}};
    for (int lane = 0; lane < lanes_of(chunk, pack); lane++)
      geo_pack_numbers(chunk->weights + (pack * GEO_PACK + lane) * size, size, lane, weights);
    model->kernel->pull(model->set, &chunk->invariants[pack], weights, &sweep, &slopes);
  }
  for (int lane = 0; lane < lanes_of(chunk, pack); lane++) {
    int at = pack * GEO_PACK + lane;
    geo_unpack_matrix(&slopes, lane, &chunk->slope[at]);
    contact_geo_frame_pull(&chunk->frame[at], &chunk->slope[at], &chunk->adjoint[at]);
  }
}

static void write_gradients(const ContactOverlapBatch *batch, const Chunk *chunk) {
  for (int at = 0; at < chunk->count; at++) {
    Place place = place_of(batch, chunk->pair[at]);
    if (chunk->is_abandoned[at]) continue;
    for (int i = 0; i < SIZE; i++) place.gradient[i] = *place.volume * chunk->adjoint[at].gradient[i];
  }
}

// ∇²V = V (∇² log V + ∇ log V ∇ log Vᵀ)
static void scale_hessian(const double *gradient, double volume, double *hessian) {
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++)
      hessian[i * SIZE + j] = volume * (hessian[i * SIZE + j] + gradient[i] * gradient[j]);
}

static Status write_hessians(const ContactGeoModel *model, const ContactOverlapBatch *batch,
                             const Chunk *chunk) {
  enum { COUNT = CONTACT_GEO_DIRECTIONS };
  int size = model->set ? model->set->count : 0, moved[CONTACT_GEO_CHUNK];
  double changes[CONTACT_GEO_CHUNK * COUNT * CONTACT_GEO_MAX_FEATURES];
  double curvature[CONTACT_GEO_CHUNK * COUNT * COUNT];
  double spare[HESSIAN_SIZE]; // for the pairs that the exact model answered
  for (int at = 0; at < chunk->count; at++) {
    double *hessian = chunk->is_abandoned[at] ? spare : place_of(batch, chunk->pair[at]).hessian;
    moved[at] =
        contact_geo_hessian_begin(model, &chunk->frame[at], chunk->weights + at * size, &chunk->slope[at],
                                  &chunk->adjoint[at], changes + at * COUNT * size, hessian);
  }
  if (model->set)
    TRY(model->network.curve(model->network.self, chunk->count, chunk->features, COUNT, changes, curvature));
  for (int at = 0; at < chunk->count; at++) {
    Place place = place_of(batch, chunk->pair[at]);
    if (chunk->is_abandoned[at]) continue;
    const double *gradient = chunk->adjoint[at].gradient;
    contact_geo_hessian_end(&chunk->frame[at], moved[at], model->set ? curvature + at * COUNT * COUNT : NULL,
                            gradient, place.hessian);
    scale_hessian(gradient, *place.volume, place.hessian);
  }
  return STATUS_OK;
}

// V and the flags of all; where V is no positive number the exact model answers.
static Status write_volumes(const ContactGeoModel *model, const ContactOverlapBatch *batch, Chunk *chunk) {
  for (int at = 0; at < chunk->count; at++) {
    Place place = place_of(batch, chunk->pair[at]);
    double phi = model->offset + (model->set ? chunk->value[at] : 0);
    *place.volume = chunk->frame[at].volume * exp(phi);
    if (place.flags) *place.flags = chunk->frame[at].is_enclosed ? CONTACT_OVERLAP_ENCLOSED : 0;
    chunk->is_abandoned[at] = !(*place.volume > 0 && *place.volume < INFINITY);
    if (chunk->is_abandoned[at]) TRY(fall_back(place));
  }
  return STATUS_OK;
}

// Pairs with coplanar faces turn to the exact volume.
static Status blend_coplanar(const ContactOverlapBatch *batch, const Chunk *chunk) {
  for (int at = 0; at < chunk->count; at++) {
    if (chunk->is_abandoned[at]) continue;
    Place place = place_of(batch, chunk->pair[at]);
    double spare[SIZE]; // the Hessian's blend needs the gradient
    if (!place.gradient) {
      for (int i = 0; i < SIZE; i++) spare[i] = *place.volume * chunk->adjoint[at].gradient[i];
      place.gradient = spare;
    }
    TRY(contact_geo_coplanar_blend(&chunk->frame[at], place.pair, place.volume, place.gradient, place.hessian,
                                   place.flags));
  }
  return STATUS_OK;
}

// V, ∇V and ∇²V.
static Status eval_chunk(const ContactGeoModel *model, const ContactOverlapBatch *batch, int begin, int end,
                         Chunk *chunk) {
  TRY(find_frames(batch, begin, end, chunk));
  if (chunk->count == 0) return STATUS_OK;
  if (model->set) {
    fill_features(model, chunk);
    TRY(model->network.eval(model->network.self, chunk->count, chunk->features, chunk->value,
                            chunk->weights));
  }
  TRY(write_volumes(model, batch, chunk));
  for (int pack = 0; pack * GEO_PACK < chunk->count; pack++) sweep_pack(model, chunk, pack);
  if (batch->gradient) write_gradients(batch, chunk);
  TRY(write_hessians(model, batch, chunk));
  return blend_coplanar(batch, chunk);
}

static Status eval_with_hessians(const ContactGeoModel *model, const ContactOverlapBatch *batch) {
  Chunk chunk;
  for (int begin = 0; begin < batch->pair_count; begin += CONTACT_GEO_CHUNK) {
    int end = begin + CONTACT_GEO_CHUNK;
    TRY(eval_chunk(model, batch, begin, end < batch->pair_count ? end : batch->pair_count, &chunk));
  }
  return STATUS_OK;
}

// ρ of a block's columns by a network that takes rows.
static Status eval_rows(const ContactGeoNetwork *network, ContactGeoBlock *block, double *value,
                        bool wants_gradient) {
  int size = network->feature_count;
  double rows[CONTACT_GEO_BLOCK * CONTACT_GEO_MAX_FEATURES],
      slopes[CONTACT_GEO_BLOCK * CONTACT_GEO_MAX_FEATURES];
  for (int at = 0; at < CONTACT_GEO_BLOCK; at++)
    for (int f = 0; f < size; f++) rows[at * size + f] = block->features[f][at];
  TRY(network->eval(network->self, CONTACT_GEO_BLOCK, rows, value, wants_gradient ? slopes : NULL));
  for (int at = 0; at < CONTACT_GEO_BLOCK && wants_gradient; at++)
    for (int f = 0; f < size; f++) block->weights[f][at] = slopes[at * size + f];
  return STATUS_OK;
}

static Status eval_network(const ContactGeoNetwork *network, ContactGeoBlock *block, double *value,
                           bool wants_gradient) {
  if (!network->eval_columns) return eval_rows(network, block, value, wants_gradient);
  return network->eval_columns(network->self, block->features[0], value,
                               wants_gradient ? block->weights[0] : NULL);
}

// What lanes could not find a frame of.
static Status answer_unfit(Place place) {
  ContactGeoFrame frame;
  if (contact_geo_frame(&frame, place.pair) != CONTACT_GEO_EMPTY) return fall_back(place);
  write_empty(place);
  return STATUS_OK;
}

static Status blend_column(const ContactGeoBlock *block, int at, Place place) {
  ContactGeoFrame frame;
  for (int k = 0; k < GEO_LANES; k++) {
    frame.slack[k] = block->slack[k][at];
    for (int c = 0; c < 3; c++) {
      frame.scaled.column[c][k] = block->scaled[c * GEO_LANES + k][at];
      frame.basis.column[c][k] = block->basis[c * GEO_LANES + k][at];
    }
    for (int l = 0; l < GEO_LANES; l++) frame.projector.row[k][l] = block->projector[geo_entry(k, l)][at];
  }
  return contact_geo_coplanar_blend(&frame, place.pair, place.volume, place.gradient, NULL, place.flags);
}

static Status write_column(const ContactGeoBlock *block, int at, bool is_enclosed, Place place) {
  *place.volume = block->factor[at];
  if (!(block->is_fit[at] > 0)) return answer_unfit(place);
  if (!(*place.volume > 0 && *place.volume < INFINITY)) return fall_back(place);
  if (place.gradient) memcpy(place.gradient, block->gradient[at], sizeof block->gradient[at]);
  if (place.flags) *place.flags = is_enclosed ? CONTACT_OVERLAP_ENCLOSED : 0;
  return block->is_close[at] > 0 ? blend_column(block, at, place) : STATUS_OK;
}

// The pairs of the bundle from `first` on.
static Status eval_block(const ContactGeoModel *model, const ContactOverlapBatch *batch,
                         ContactGeoBundle *bundle, int first, ContactGeoBlock *block) {
  _Alignas(64) double value[CONTACT_GEO_BLOCK] = {0};
  model->bundle_kernel->frame(bundle, first, block);
  if (model->set) {
    model->bundle_kernel->features(model->set, block);
    TRY(eval_network(&model->network, block, value, batch->gradient != NULL));
  }
  for (int at = 0; at < CONTACT_GEO_BLOCK; at++)
    block->factor[at] = block->volume[at] * exp(model->offset + value[at]);
  if (batch->gradient) model->bundle_kernel->pull(model->set, block);
  for (int at = 0; at < CONTACT_GEO_BLOCK && first + at < bundle->count; at++)
    TRY(write_column(block, at, bundle->is_enclosed[first + at], place_of(batch, bundle->pair[first + at])));
  return STATUS_OK;
}

static Status eval_bundle(const ContactGeoModel *model, const ContactOverlapBatch *batch,
                          ContactGeoBundle *bundle, ContactGeoBlock *block) {
  model->bundle_kernel->gate(batch->pair_count, batch->pairs, bundle);
  for (int i = 0; i < batch->pair_count; i++) {
    if (bundle->outcome[i] == CONTACT_GEO_EMPTY) write_empty(place_of(batch, i));
    if (bundle->outcome[i] == CONTACT_GEO_UNFIT) TRY(fall_back(place_of(batch, i)));
  }
  for (int first = 0; first < bundle->count; first += CONTACT_GEO_BLOCK)
    TRY(eval_block(model, batch, bundle, first, block));
  return STATUS_OK;
}

Status contact_geo_eval(const ContactGeoModel *model, const ContactOverlapBatch *batch) {
  if (batch->hessian) return eval_with_hessians(model, batch);
  ContactGeoBundle bundle;
  ContactGeoBlock block;
  for (int begin = 0; begin < batch->pair_count; begin += CONTACT_GEO_BUNDLE) {
    ContactOverlapBatch part = contact_overlap_part(batch, begin, CONTACT_GEO_BUNDLE);
    TRY(eval_bundle(model, &part, &bundle, &block));
  }
  return STATUS_OK;
}

ContactGeoOutcome contact_geo_features_tangent(const ContactGeoFeatureSet *set, const double pair[24],
                                               int count, const double *directions, double *features,
                                               double *feature_changes, double *log_volume,
                                               double *log_volume_changes) {
  const ContactGeoKernel *kernel = contact_geo_kernel();
  ContactGeoFrame frame;
  ContactGeoOutcome outcome = contact_geo_frame(&frame, pair);
  if (outcome != CONTACT_GEO_INSIDE) return outcome;
  *log_volume = log(frame.volume);
  GeoSymmetric projector, projector_change;
  ContactGeoInvariants invariants, change;
  GeoPack packs[CONTACT_GEO_MAX_FEATURES];
  for (int lane = 0; lane < GEO_PACK; lane++) geo_pack_matrix(&frame.projector, lane, &projector);
  kernel->features(set, &projector, &invariants, packs);
  geo_unpack_numbers(packs, set->count, 0, features);
  for (int d = 0; d < count; d++) {
    int lane = d % GEO_PACK;
    if (lane == 0) memset(&projector_change, 0, sizeof projector_change);
    ContactGeoTangent tangent;
    contact_geo_frame_push(&frame, directions + (size_t)d * SIZE, &tangent);
    log_volume_changes[d] = tangent.log_volume;
    geo_pack_matrix(&tangent.projector, lane, &projector_change);
    if (lane < GEO_PACK - 1 && d < count - 1) continue;
    kernel->push(set, &invariants, &projector_change, &change, packs);
    for (int l = 0; l <= lane; l++)
      geo_unpack_numbers(packs, set->count, l, feature_changes + (size_t)(d - lane + l) * (size_t)set->count);
  }
  return outcome;
}
