// SPDX-License-Identifier: Apache-2.0
// Centre to second derivatives of a bundle of pairs for any processor.
#include "overlap/geo/features/pack_portable.h"

#pragma GCC diagnostic ignored "-Wunused-function" // of single pairs

#include <string.h>

#include "overlap/geo/features/features.h"

#pragma GCC diagnostic ignored "-Wpsabi" // packs are returned by inlined functions only

#include "overlap/geo/features/forward.inc"

#include "overlap/geo/features/change.inc"

#include "overlap/geo/features/backward.inc"

#include "overlap/geo/features/curve.inc"

#include "overlap/geo/bundle/frame.inc"

#include "overlap/geo/bundle/centroid.inc"

#include "overlap/geo/bundle/hessian.inc"
