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
  *model = (ContactGeoModel){.kernel = contact_geo_kernel(), .offset = log(1.28)};
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
    if (!place.gradient && place.hessian) {
      for (int i = 0; i < SIZE; i++) spare[i] = *place.volume * chunk->adjoint[at].gradient[i];
      place.gradient = spare;
    }
    TRY(contact_geo_coplanar_blend(&chunk->frame[at], place.pair, place.volume, place.gradient, place.hessian,
                                   place.flags));
  }
  return STATUS_OK;
}

static Status eval_chunk(const ContactGeoModel *model, const ContactOverlapBatch *batch, int begin, int end,
                         Chunk *chunk) {
  TRY(find_frames(batch, begin, end, chunk));
  if (chunk->count == 0) return STATUS_OK;
  bool wants_derivatives = batch->gradient || batch->hessian;
  if (model->set) {
    fill_features(model, chunk);
    TRY(model->network.eval(model->network.self, chunk->count, chunk->features, chunk->value,
                            wants_derivatives ? chunk->weights : NULL));
  }
  TRY(write_volumes(model, batch, chunk));
  if (!wants_derivatives) return blend_coplanar(batch, chunk);
  for (int pack = 0; pack * GEO_PACK < chunk->count; pack++) sweep_pack(model, chunk, pack);
  if (batch->gradient) write_gradients(batch, chunk);
  if (batch->hessian) TRY(write_hessians(model, batch, chunk));
  return blend_coplanar(batch, chunk);
}

Status contact_geo_eval(const ContactGeoModel *model, const ContactOverlapBatch *batch) {
  Chunk chunk;
  for (int begin = 0; begin < batch->pair_count; begin += CONTACT_GEO_CHUNK) {
    int end = begin + CONTACT_GEO_CHUNK;
    TRY(eval_chunk(model, batch, begin, end < batch->pair_count ? end : batch->pair_count, &chunk));
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
