// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/limits.h"

// The promises; where nothing jumps a gain of so many times as much shows an error.
#define ENERGY 1e-3
#define MOMENTUM 1e-3
#define WITHOUT_CONTACT 20

const FemLimits fem_limits = {
    .energy = ENERGY,
    .energy_near = 0.8 * ENERGY, // the rest is for steps that cannot be shortened
    .energy_step = 1e-3 * ENERGY,
    .energy_without_contact = WITHOUT_CONTACT * ENERGY,
    .energy_step_without_contact = 5 * WITHOUT_CONTACT * ENERGY,
    .turned = 0.3 * ENERGY,
    .momentum = MOMENTUM,
    .momentum_near = 0.6 * MOMENTUM,
    .momentum_far = 0.9 * MOMENTUM, // the rest is for steps that cannot be shortened
    .momentum_step = 0.01 * MOMENTUM,
    .momentum_owed = 0.3 * MOMENTUM,
    .momentum_strict = 0.5 * MOMENTUM,
    .strictest = 0.3,
};
