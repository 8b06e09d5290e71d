// SPDX-License-Identifier: GPL-3.0-or-later
// Energies and powers of a system at a state: those of its effects, of the motion, and of what drives it.
#ifndef TETLAP_FEM_EFFECT_SYSTEM_ENERGY_H
#define TETLAP_FEM_EFFECT_SYSTEM_ENERGY_H

#include "fem/effect/system.h"

// All of them. Evaluates the forces where driven vertices need them, into system->forces. Failures as those
// of forces.
Status fem_system_energy(FemSystem *system, const FemState *state, FemEnergy *energy);
// Of the damping of materials alone [W]. Over ranks the sum.
Status fem_system_damping_power(FemSystem *system, const FemState *state, double *power);

#endif
