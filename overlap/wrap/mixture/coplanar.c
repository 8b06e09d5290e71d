// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/mixture/coplanar.h"

#include <string.h>

#include "overlap/geo/coplanar.h"
#include "overlap/wrap/mixture/mixture.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

static Status share(const OverlapWrap *wrap, const OverlapBatch *portion, int order,
                    OverlapWrapShares *shares) {
  (void)wrap;
  for (int i = 0; i < portion->pair_count; i++) {
    OverlapGeoFrame frame;
    OverlapGeoCoplanar coplanar;
    shares->value[i] = 0;
    if (overlap_geo_frame(&frame, portion->pairs + SIZE * i) != OVERLAP_GEO_INSIDE) continue;
    overlap_geo_coplanar_find(&frame.projector, &coplanar);
    shares->value[i] = coplanar.share;
    if (coplanar.share > 0 && order > 0)
      overlap_geo_coplanar_pull(&frame, &coplanar, shares->gradient[i],
                                order > 1 ? shares->hessian[i] : NULL);
  }
  return STATUS_OK;
}

static const OverlapWrapMixture mixture = {.has_clip = true, .share = share};

const OverlapWrapKind overlap_wrap_coplanar = {
    .name = "coplanar",
    .help = "clip has a part in pairs with nearly coplanar faces",
    .eval = overlap_wrap_mixture_eval,
    .eval_slopes = overlap_wrap_mixture_slopes,
    .centroid = OVERLAP_WRAP_MIXED_CENTROID,
    .mixture = &mixture,
};
