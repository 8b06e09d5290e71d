// SPDX-License-Identifier: Apache-2.0
// `geo` behind the interface of the overlap models: what an operations table of theirs points to.
#ifndef TETLAP_OVERLAP_GEO_MODEL_H
#define TETLAP_OVERLAP_GEO_MODEL_H

#include "overlap/geo/geo.h"
#include "overlap/geo/network.h"

typedef struct OverlapGeoOverlap {
  OverlapGeoModel model;
  OverlapGeoNet *net; // owned; NULL: no network, φ = ln 1.28
} OverlapGeoOverlap;

// The shipped models: `geo` (120 features, 48 × 2), `geo-small` (56 features, 16 × 2).
extern const OverlapOps overlap_geo_ops;
extern const OverlapOps overlap_geo_small_ops;

// From a weights file; `path` NULL: without a network. `*self` is an OverlapGeoOverlap.
Status overlap_geo_model_create(void **self, const char *path);
void overlap_geo_model_destroy(void *self);

// As OverlapOps.eval_pair.
Status overlap_geo_model_eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer);

// As OverlapOps.eval_batch: over OpenMP threads, the same results for any number of them.
Status overlap_geo_model_eval_batch(const void *self, const OverlapBatch *batch);

#endif
