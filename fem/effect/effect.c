// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/effect.h"

// One line an effect; forces are summed in this order.
// clang-format off
static const FemEffectOps *const effects[] = {
    &fem_effect_elasticity,
    &fem_effect_volume,
    &fem_effect_plasticity,
    &fem_effect_damping,
    &fem_effect_gravity,
    &fem_effect_loads,
    &fem_effect_contact,
    &fem_effect_stick,
    &fem_effect_viscosity,
};
// clang-format on

const FemEffectOps *const *fem_effect_list(int *count) {
  *count = (int)(sizeof effects / sizeof *effects);
  return effects;
}
