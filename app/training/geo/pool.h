// SPDX-License-Identifier: GPL-3.0-or-later
// What training `geo` sees of its pairs, computed once: whitened features w of the analytic-centre frame, the
// target t = ln V − ln V₀, and how both change when vertices move.
//
// φ and t are unchanged by affine maps of space, so of the 24 directions in a pair's coordinates twelve say
// nothing. Rates are kept along an orthonormal basis of the other twelve: along a normally distributed
// direction of all 24 the changes are Σ_q z_q rates_q with twelve normal z, whatever the basis. They are
// multiplied by V/‖∇V‖, which makes them numbers without unit.
#ifndef TETLAP_APP_TRAINING_GEO_POOL_H
#define TETLAP_APP_TRAINING_GEO_POOL_H

#include "base/status.h"
#include "datagen/pairs.h"
#include "net/model/whitening.h"
#include "overlap/geo/features/features.h"

enum { APP_POOL_RATES = 12 };

typedef struct AppTrainingPool {
  const OverlapGeoFeatureSet *set;
  int count;
  float *inputs;          // w                                  (count, features)
  float *rates;           // V/‖∇V‖ · change of w               (count, 12, features)
  float *targets;         // t                                  (count)
  float *target_rates;    // V/‖∇V‖ · change of t               (count, 12)
  float *onset;           // w at the onset of an overlap       (features)
  NetWhitening whitening; // owned
  long long left_out;     // pairs without volume, or left to the exact model
} AppTrainingPool;

// From the pairs (with ∇V) that have a frame. `whitening` with count 0 is fitted to them, else copied.
// STATUS_INPUT: fewer than two pairs are left.
Status app_training_pool_create(AppTrainingPool *pool, const OverlapGeoFeatureSet *set,
                                const DatagenPairs *pairs, size_t count, const NetWhitening *whitening);
void app_training_pool_destroy(AppTrainingPool *pool); // a zeroed one is accepted

// An orthonormal basis (12, 24) of the directions that no affine map of space makes.
void app_training_pool_basis(const double pair[24], double basis[APP_POOL_RATES * 24]);

#endif
