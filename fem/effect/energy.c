// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/energy.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

static_assert(sizeof(FemEnergy) == FEM_ENERGY_TERMS * sizeof(double), "terms[] are all of them");

void fem_energy_add(FemEnergy *to, const FemEnergy *more) {
  for (int i = 0; i < FEM_ENERGY_TERMS; i++) to->terms[i] += more->terms[i];
}

const char *fem_energy_faulty_term(const FemEnergy *energy) {
  static const char *const names[] = {"kinetic energy",
                                      "elastic energy",
                                      "energy of gravity",
                                      "energy of contact",
                                      "dissipated power",
                                      "driven power",
                                      "work of loads",
                                      "plastic work",
                                      "work of friction",
                                      "kinetic energy of the common velocity",
                                      "energy of gravity of the common motion",
                                      "power of friction along reversed slip"};
  static_assert(sizeof names == FEM_ENERGY_TERMS * sizeof *names, "a name for each");
  for (int i = 0; i < FEM_ENERGY_TERMS; i++)
    if (!isfinite(energy->terms[i])) return names[i];
  return NULL;
}
