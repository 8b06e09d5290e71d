// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/polytope.h"

#include <float.h>
#include <stdbool.h>

#define INLINED static inline

#include "overlap/clip/polytope.inc"

OverlapClipOutcome overlap_clip_polytope_make(OverlapClipPolytope *polytope, const double pair[24]) {
  return make_polytope(polytope, pair);
}
