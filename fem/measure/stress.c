// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/stress.h"

#include <math.h>
#include <string.h>

#include "fem/effect/elements/plasticity.h"
#include "fem/effect/elements/volume_effect.h"

void fem_stress_find(const FemSystem *system, const FemState *state, int tet, double stress[6]) {
  const FemModel *model = system->model;
  const FemModelBody *body = &model->bodies[model->tet_body[tet]];
  for (int s = 0; s < 6; s++) stress[s] = 0;
  if (body->is_obstacle) return;
  fem_model_stress(model, tet, state->positions, stress);
  void *volume = body->element == FEM_ELEMENT_NODAL ? fem_system_effect(system, &fem_effect_volume) : NULL;
  if (volume) {
    double corners[12];
    for (int k = 0; k < 4; k++)
      memcpy(corners + 3 * k, state->positions + 3 * (size_t)model->tets[tet][k], 3 * sizeof *corners);
    fem_effect_volume_add_stress(volume, tet, corners, stress);
  }
  void *plasticity = fem_system_effect(system, &fem_effect_plasticity);
  if (plasticity) fem_effect_plasticity_add_stress(plasticity, tet, state, stress);
}

double fem_stress_von_mises(const double s[6]) {
  double normal =
      (s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) + (s[2] - s[0]) * (s[2] - s[0]);
  return sqrt(0.5 * normal + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}
