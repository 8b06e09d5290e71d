// SPDX-License-Identifier: Apache-2.0
// What becomes of volumes that no two tetrahedra share: not finite, below 0, or above the smaller one.
// `strict` makes them errors, `lenient` lets a run go on: they are flagged UNSOUND, and what is not finite is
// 0. Models of users know it themselves (OverlapUnsound), as deep as they stand; what comes out is looked at
// here.
#ifndef TETLAP_OVERLAP_WRAP_SOUND_H
#define TETLAP_OVERLAP_WRAP_SOUND_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_strict, overlap_wrap_lenient;

#endif
