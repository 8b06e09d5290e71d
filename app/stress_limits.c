// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress_limits.h"

#include <stddef.h>
#include <string.h>

static const AppStressLimit limits[] = {
    {"two spheres", NULL, "change of angular momentum",
     "BDF keeps linear momentum, not angular momentum, which is quadratic: it errs by the tolerance",
     "history.csv: angular_x, angular_y, angular_z"},
    {"nearly incompressible, 0.499", NULL, "error of the deflection",
     "elements of 12.5 mm along the beam: 17 % off with 20 mm, 12 % with these; it falls with refinement",
     NULL},
    {"wedges, parallel", NULL, "asymmetry in x",
     "an edge balanced on an edge is an unstable equilibrium: rounding decides to which side it slides off",
     NULL},
};

const AppStressLimit *app_stress_limits_find(const char *name, const char *model, const char *measure) {
  for (size_t l = 0; l < sizeof limits / sizeof *limits; l++)
    if (strcmp(limits[l].name, name) == 0 && strcmp(limits[l].measure, measure) == 0 &&
        (!limits[l].model || strcmp(limits[l].model, model) == 0))
      return &limits[l];
  return NULL;
}
