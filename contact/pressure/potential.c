// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/potential.h"

double contact_potential_curvature(const ContactLayout *layout, const ContactInterfaceDef *interface,
                                   const ContactNode *node) {
  return interface->weight[node->side] * interface->stiffness / layout->vertex_volumes[node->vertex];
}

// U = Σ_a ½ c_a W_a²; ∂U/∂W_i = ¼ Σ_{a∈i} c_a W_a.
double contact_potential_apply(const ContactLayout *layout, const ContactPatches *patches,
                               const ContactPatch *patch, double *pressures) {
  const ContactInterfaceDef *interface = &layout->interfaces[patch->interface];
  double energy = 0;
  for (int n = patch->node_begin; n < patch->node_end; n++) {
    const ContactNode *node = &patches->nodes[n];
    energy += 0.5 * contact_potential_curvature(layout, interface, node) * node->covered * node->covered;
  }
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    pressures[k] = 0;
    for (int side = 0; side < 2; side++) {
      if (patches->pair_elements[k][side] < 0) continue;
      const int *nodes = patches->elements[patches->pair_elements[k][side]].nodes;
      for (int v = 0; v < 4; v++) {
        const ContactNode *node = &patches->nodes[nodes[v]];
        pressures[k] += 0.25 * contact_potential_curvature(layout, interface, node) * node->covered;
      }
    }
  }
  return energy;
}
