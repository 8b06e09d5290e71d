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
  long long apart;        // pairs left out: they share no volume, so there is no ln V to learn
  long long unfit; // pairs left out: too flat for the frame, so that `geo` leaves them to the exact model
} AppTrainingPool;

// From the pairs (with ∇V) that have a frame. `whitening` with count 0 is fitted to them, else copied.
// STATUS_INPUT: fewer than two pairs are left.
Status app_training_pool_create(AppTrainingPool *pool, const OverlapGeoFeatureSet *set,
                                const DatagenPairs *pairs, size_t count, const NetWhitening *whitening);
void app_training_pool_destroy(AppTrainingPool *pool); // a zeroed one is accepted

// "3000 pairs to train on; 1000 left out: 990 share no volume, 10 are too flat for the features".
// `unanswered` of those without volume are left out since the network that is bounded does not answer them.
void app_training_pool_describe(const AppTrainingPool *pool, long long unanswered, char *text, size_t size);

// An orthonormal basis (12, 24) of the directions that no affine map of space makes.
void app_training_pool_basis(const double pair[24], double basis[APP_POOL_RATES * 24]);

#endif
