// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/potential.h"

#include <assert.h>
#include <math.h>

double contact_potential_node_curvature(const ContactLayout *layout, const ContactFacing *facing,
                                        const ContactNode *node) {
  return facing->weight[node->side] * facing->stiffness / layout->vertex_volumes[node->vertex];
}

double contact_potential_element_curvature(const ContactLayout *layout, const ContactFacing *facing,
                                           const ContactElement *element) {
  return facing->weight[element->side] * facing->stiffness / layout->cell_volumes[element->tet];
}

double contact_potential_pair_curvature(const ContactLayout *layout, const ContactPair *pair) {
  double reference = layout->cell_volumes[pair->tets[0]];
  if (pair->tets[1] >= 0) reference = fmin(reference, layout->cell_volumes[pair->tets[1]]);
  return layout->facings[pair->facing].stiffness / reference;
}

// U = Σ_a ½ c_a W_a²; ∂U/∂W_i = ¼ Σ_{a∈i} c_a W_a.
static double apply_nodal(const ContactLayout *layout, const ContactPatches *patches,
                          const ContactPatch *patch, double *pressures) {
  const ContactFacing *facing = &layout->facings[patch->facing];
  double energy = 0;
  for (int n = patch->node_begin; n < patch->node_end; n++) {
    const ContactNode *node = &patches->nodes[n];
    energy += 0.5 * contact_potential_node_curvature(layout, facing, node) * node->covered * node->covered;
  }
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    pressures[k] = 0;
    for (int side = 0; side < 2; side++) {
      if (patches->pair_elements[k][side] < 0) continue;
      const int *nodes = patches->elements[patches->pair_elements[k][side]].nodes;
      for (int v = 0; v < 4; v++) {
        const ContactNode *node = &patches->nodes[nodes[v]];
        pressures[k] += 0.25 * contact_potential_node_curvature(layout, facing, node) * node->covered;
      }
    }
  }
  return energy;
}

// U = Σ_i ½ c_i W_i².
static double apply_element(const ContactLayout *layout, const ContactPatches *patches,
                            const ContactPatch *patch, double *pressures) {
  const ContactFacing *facing = &layout->facings[patch->facing];
  double energy = 0;
  for (int e = patch->element_begin; e < patch->element_end; e++) {
    const ContactElement *element = &patches->elements[e];
    energy += 0.5 * contact_potential_element_curvature(layout, facing, element) * element->covered *
              element->covered;
  }
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    pressures[k] = 0;
    for (int side = 0; side < 2; side++) {
      if (patches->pair_elements[k][side] < 0) continue;
      const ContactElement *element = &patches->elements[patches->pair_elements[k][side]];
      pressures[k] += contact_potential_element_curvature(layout, facing, element) * element->covered;
    }
  }
  return energy;
}

// U = Σ_ij ½ c_ij V_ij².
static double apply_pair(const ContactLayout *layout, const ContactPatch *patch, const ContactPair *pairs,
                         const double *volumes, double *pressures) {
  double energy = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    pressures[k] = contact_potential_pair_curvature(layout, &pairs[k]) * volumes[k];
    energy += 0.5 * pressures[k] * volumes[k];
  }
  return energy;
}

static double sum_of(const double *volumes, const ContactPatch *patch) {
  double sum = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++) sum += volumes[k];
  return sum;
}

static void fill(double *pressures, const ContactPatch *patch, double pressure) {
  for (int k = patch->pair_begin; k < patch->pair_end; k++) pressures[k] = pressure;
}

double contact_potential_apply(const ContactLayout *layout, const ContactPatches *patches,
                               const ContactPatch *patch, const ContactPair *pairs, const double *volumes,
                               double *pressures) {
  double stiffness = layout->facings[patch->facing].stiffness, total = sum_of(volumes, patch);
  switch (layout->def.potential) {
  case CONTACT_POTENTIAL_NODAL:
    return apply_nodal(layout, patches, patch, pressures);
  case CONTACT_POTENTIAL_ELEMENT:
    return apply_element(layout, patches, patch, pressures);
  case CONTACT_POTENTIAL_PAIR:
    return apply_pair(layout, patch, pairs, volumes, pressures);
  case CONTACT_POTENTIAL_LINEAR:
    fill(pressures, patch, stiffness);
    return stiffness * total;
  case CONTACT_POTENTIAL_BODY:
    fill(pressures, patch, stiffness * total);
    return 0.5 * stiffness * total * total;
  case CONTACT_POTENTIAL_FIELD:
    break; // knows no pressure of a pair: contact/pressure/field.h
  }
  assert(0 && "no such potential");
  return NAN;
}
