// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/def.h"

#include <assert.h>

static const struct {
  const char *name, *help;
} POTENTIALS[CONTACT_POTENTIAL_COUNT] = {
    [CONTACT_POTENTIAL_NODAL] = {"nodal", "covered over rest volume of each vertex, squared: for models "
                                          "whose V is usable and whose centroid is not; "
                                          "no friction, no viscosity [Pa]"},
    [CONTACT_POTENTIAL_FIELD] =
        {"field", "depth in the other body, over rest volume: uniform pressure whatever the meshes, every "
                  "pair balances [Pa/m]"},
};

const char *contact_def_potential_name(ContactPotential potential) {
  assert((unsigned)potential < CONTACT_POTENTIAL_COUNT);
  return POTENTIALS[potential].name;
}

const char *contact_def_potential_unit(ContactPotential potential) {
  return potential == CONTACT_POTENTIAL_FIELD ? "Pa/m" : "Pa";
}

const char *contact_def_potential_help(ContactPotential potential) {
  assert((unsigned)potential < CONTACT_POTENTIAL_COUNT);
  return POTENTIALS[potential].help;
}
