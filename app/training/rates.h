// SPDX-License-Identifier: GPL-3.0-or-later
// What a TetrahedronPairNet can learn of ∇V, for pairs in the unit frame. There V' depends on the second
// tetrahedron alone: the rest of ∇V is the normalisation's and exact. So rates are those of v, the network's
// volume, along movements of the second tetrahedron's vertices,
//
//     δy_b = ℓ E⁻¹ d_b,   δv = Σ_b r_b · d_b,   r_b = scale ℓ/|det E| ∂V/∂x_b,   ℓ = |det E|^(1/3),
//
// d (4, 3) movements in space by the first tetrahedron's size ℓ, E its edges.
#ifndef TETLAP_APP_TRAINING_RATES_H
#define TETLAP_APP_TRAINING_RATES_H

#include <stddef.h>

#include "base/status.h"
#include "net/model/random.h"
#include "overlap/tpn/normalise.h"

enum { APP_RATES_FRAME = 9, APP_RATES = 12 };

typedef struct AppTrainingRates {
  float *frame; // ℓ E⁻¹                     (count, 3, 3)
  float *rate;  // r                         (count, 4, 3)
  float *size;  // ‖r‖                       (count)
  double soft;  // a share of the mean of ‖r‖ over pairs that share volume
} AppTrainingRates;

Status app_training_rates_create(AppTrainingRates *rates, size_t count);
void app_training_rates_destroy(AppTrainingRates *rates); // a zeroed one is accepted

// The pair at `at`: normalised by Unit, ∇V of the pair as it came; the network's output is scale · V'.
void app_training_rates_set(AppTrainingRates *rates, int at, const OverlapTpnNormalised *normalised,
                            const double gradient[24], double scale);
// After the last of them.
void app_training_rates_finish(AppTrainingRates *rates, int count);

// A random movement d of the pair at `at`, normally distributed: `direction` of the network's 24 inputs, and
// the change of v. Both are divided by ‖r‖ + soft: errors of small rates count relative to `soft`.
float app_training_rates_draw(const AppTrainingRates *rates, int at, NetRandom *random, float direction[24]);

#endif
