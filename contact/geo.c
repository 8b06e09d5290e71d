// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo.h"

#include <math.h>
#include <string.h>

#include "contact/clip.h"
#include "contact/exact.h"
#include "contact/geo_hessian.h"

enum { SIZE = CONTACT_PAIR_SIZE, HESSIAN_SIZE = SIZE * SIZE };

Status contact_geo_model_create(ContactGeoModel *model, const ContactGeoNetwork *network) {
  *model = (ContactGeoModel){.offset = log(1.28)};
  if (!network) return STATUS_OK;
  model->set = contact_geo_feature_set(network->feature_count);
  if (!model->set)
    return status_fail(STATUS_INPUT, "the network has %d inputs: the features of a pair are 36, 70 or 100",
                       network->feature_count);
  model->network = *network;
  GeoMatrix onset;
  ContactGeoInvariants invariants;
  double features[CONTACT_GEO_MAX_FEATURES], value;
  contact_geo_onset(&onset);
  contact_geo_features(model->set, &onset, &invariants, features);
  TRY(network->eval(network->self, 1, features, &value, NULL));
  if (!isfinite(value))
    return status_fail(STATUS_INPUT, "the network's value at the onset of an overlap is %g", value);
  model->offset -= value;
  return STATUS_OK;
}

// The pairs of a chunk that have a frame, and what is known of them.
typedef struct Chunk {
  int count;
  int pair[CONTACT_GEO_CHUNK]; // index in the batch
  ContactGeoFrame frame[CONTACT_GEO_CHUNK];
  ContactGeoInvariants invariants[CONTACT_GEO_CHUNK];
  double features[CONTACT_GEO_CHUNK * CONTACT_GEO_MAX_FEATURES]; // (count, set->count)
  double value[CONTACT_GEO_CHUNK];                               // ρ
  double weights[CONTACT_GEO_CHUNK * CONTACT_GEO_MAX_FEATURES];  // dρ/df (count, set->count)
} Chunk;

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

static Status find_frames(const ContactGeoModel *model, const ContactOverlapBatch *batch, int begin, int end,
                          Chunk *chunk) {
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
    if (model->set)
      contact_geo_features(model->set, &frame->projector, &chunk->invariants[chunk->count],
                           chunk->features + chunk->count * model->set->count);
    chunk->pair[chunk->count++] = i;
  }
  return STATUS_OK;
}

static Status write_derivatives(const ContactGeoModel *model, const Chunk *chunk, int at, Place place) {
  const ContactGeoFrame *frame = &chunk->frame[at];
  const ContactGeoInvariants *invariants = &chunk->invariants[at];
  int first = model->set ? at * model->set->count : 0;
  const double *weights = chunk->weights + first, *features = chunk->features + first;
  ContactGeoSweep sweep;
  ContactGeoAdjoint adjoint;
  GeoMatrix slope = {{{0}}};
  if (model->set) contact_geo_features_pull(model->set, invariants, weights, &sweep, &slope);
  contact_geo_frame_pull(frame, &slope, &adjoint);
  double volume = *place.volume;
  if (place.gradient)
    for (int i = 0; i < SIZE; i++) place.gradient[i] = volume * adjoint.gradient[i];
  if (!place.hessian) return STATUS_OK;
  TRY(contact_geo_hessian(model, frame, invariants, features, weights, &sweep, &slope, &adjoint,
                          place.hessian));
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++) {
      double *second = place.hessian + i * SIZE + j;
      *second = volume * (*second + adjoint.gradient[i] * adjoint.gradient[j]);
    }
  return STATUS_OK;
}

static Status eval_chunk(const ContactGeoModel *model, const ContactOverlapBatch *batch, int begin, int end,
                         Chunk *chunk) {
  TRY(find_frames(model, batch, begin, end, chunk));
  bool wants_derivatives = batch->gradient || batch->hessian;
  if (model->set && chunk->count > 0)
    TRY(model->network.eval(model->network.self, chunk->count, chunk->features, chunk->value,
                            wants_derivatives ? chunk->weights : NULL));
  for (int at = 0; at < chunk->count; at++) {
    Place place = place_of(batch, chunk->pair[at]);
    double phi = model->offset + (model->set ? chunk->value[at] : 0);
    *place.volume = chunk->frame[at].volume * exp(phi);
    if (!(*place.volume > 0 && *place.volume < INFINITY)) {
      TRY(fall_back(place));
      continue;
    }
    if (place.flags) *place.flags = chunk->frame[at].is_enclosed ? CONTACT_OVERLAP_ENCLOSED : 0;
    if (wants_derivatives) TRY(write_derivatives(model, chunk, at, place));
  }
  return STATUS_OK;
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
  ContactGeoFrame frame;
  ContactGeoOutcome outcome = contact_geo_frame(&frame, pair);
  if (outcome != CONTACT_GEO_INSIDE) return outcome;
  ContactGeoInvariants invariants, change;
  contact_geo_features(set, &frame.projector, &invariants, features);
  *log_volume = log(frame.volume);
  for (int d = 0; d < count; d++) {
    ContactGeoTangent tangent;
    contact_geo_frame_push(&frame, directions + (size_t)d * SIZE, &tangent);
    contact_geo_features_push(set, &invariants, &tangent.projector, &change,
                              feature_changes + (size_t)d * (size_t)set->count);
    log_volume_changes[d] = tangent.log_volume;
  }
  return outcome;
}
