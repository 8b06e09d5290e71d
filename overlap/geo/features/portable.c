// SPDX-License-Identifier: Apache-2.0
// Features for any processor.

#include <string.h>

#include "overlap/geo/features/features.h"

#pragma GCC diagnostic ignored "-Wpsabi" // packs are returned by inlined functions only

#include "overlap/geo/features/forward.inc"

#include "overlap/geo/features/change.inc"

#include "overlap/geo/features/backward.inc"

#include "overlap/geo/features/bend.inc"

#include "overlap/geo/features/planes.inc"

const OverlapGeoKernel overlap_geo_features_kernel_portable = {
    .name = "portable",
    .features = features,
    .planes = planes,
    .push = push,
    .push_planes = push_planes,
    .pull = pull,
    .bend = bend,
};
