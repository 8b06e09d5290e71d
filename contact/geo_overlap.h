// SPDX-License-Identifier: GPL-3.0-or-later
// `geo` behind the interface of the overlap models: what an operations table of theirs points to.
#ifndef TETLAP_CONTACT_GEO_OVERLAP_H
#define TETLAP_CONTACT_GEO_OVERLAP_H

#include "contact/geo.h"
#include "contact/geo_net.h"

typedef struct ContactGeoOverlap {
  ContactGeoModel model;
  ContactGeoNet *net; // owned; NULL: no network, φ = ln 1.28
} ContactGeoOverlap;

// The shipped models: `geo` (100 features, 32 × 3), `geo-small` (36 features, 16 × 2).
extern const ContactOverlapOps contact_overlap_geo;
extern const ContactOverlapOps contact_overlap_geo_small;

// From a weights file; `path` NULL: without a network. `*self` is a ContactGeoOverlap.
Status contact_geo_overlap_create(void **self, const char *path);
void contact_geo_overlap_destroy(void *self);

// As ContactOverlapOps.eval_pair.
Status contact_geo_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags);

// As ContactOverlapOps.eval_batch: over OpenMP threads, the same results for any number of them.
Status contact_geo_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch);

#endif
