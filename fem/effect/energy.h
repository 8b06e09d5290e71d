// SPDX-License-Identifier: GPL-3.0-or-later
// The energies of a state, by kind, and its powers and works; each effect adds its own.
#ifndef TETLAP_FEM_EFFECT_ENERGY_H
#define TETLAP_FEM_EFFECT_ENERGY_H

enum { FEM_ENERGY_TERMS = 12 };

typedef union FemEnergy {
  struct {
    double kinetic; // of the unknown coordinates [J]
    double elastic, gravity, contact;
    double dissipated_power; // ≥ 0 [W]
    double driven_power;     // of whatever moves prescribed coordinates and obstacles [W]
    double applied_work;     // of loads since the start [J]
    double plastic_work;     // dissipated by plasticity since the start [J]
    double friction_work;    // dissipated by friction with a history since the start [J]
    double common_kinetic;   // of `kinetic`, that of the common velocity (fem/model/floating.h)
    double common_gravity;   // likewise: all of `gravity` where bodies float, else nothing
    double turned_power;     // of friction that drives slip, since it has reversed within a step [W]
  };
  double terms[FEM_ENERGY_TERMS]; // all of these
} FemEnergy;

void fem_energy_add(FemEnergy *to, const FemEnergy *more);
// In words, the first term that is not a finite number; NULL: all are.
const char *fem_energy_faulty_term(const FemEnergy *energy);

#endif
