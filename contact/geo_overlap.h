// SPDX-License-Identifier: GPL-3.0-or-later
// `geo` behind the interface of the overlap models: what an operations table of theirs points to, with a
// ContactGeoModel as `self`.
#ifndef TETLAP_CONTACT_GEO_OVERLAP_H
#define TETLAP_CONTACT_GEO_OVERLAP_H

#include "contact/geo.h"

// As ContactOverlapOps.eval_pair.
Status contact_geo_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags);

// As ContactOverlapOps.eval_batch: over OpenMP threads, the same results for any number of them.
Status contact_geo_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch);

#endif
