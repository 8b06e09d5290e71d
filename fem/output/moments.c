// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/moments.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/stick.h"
#include "fem/effect/contact/viscosity.h"

static void add_patches(const ContactEvaluation *evaluation, double (*moments)[3]) {
  const ContactPatches *patches = &evaluation->patches;
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    for (int n = patch->node_begin; n < patch->node_end; n++) {
      const ContactNode *node = &patches->nodes[n];
      if (node->side != 0) continue;
      Vec3 x = vec3_at(evaluation->positions + 3 * (size_t)node->vertex);
      vec3_accumulate(moments[patch->interface], vec3_cross(x, vec3_at(node->force)));
    }
  }
}

// Each pair's pull acts at x̄.
static void add_stick(const ContactStick *stick, const double *positions, double (*moments)[3]) {
  for (int k = 0; k < stick->pair_count; k++) {
    const ContactStickPair *pair = &stick->pairs[k];
    Vec3 at = {0, 0, 0};
    for (int v = 0; v < 4; v++)
      at = vec3_add(
          at, vec3_scale(pair->lambda[0][v], vec3_at(positions + 3 * (size_t)stick->tets[pair->tets[0]][v])));
    vec3_accumulate(moments[pair->interface], vec3_cross(at, vec3_at(stick->pulls[k])));
  }
}

static Status add_friction(void *stick, const FemState *state, const ContactEvaluation *evaluation,
                           double (*moments)[3]) {
  const ContactStick *law;
  TRY(fem_effect_stick_evaluate(stick, state, &law));
  add_stick(law, evaluation->positions, moments);
  return STATUS_OK;
}

Status fem_moments_find(const FemSystem *system, const FemState *state, double (*moments)[3]) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  void *stick = fem_system_effect(system, &fem_effect_stick);
  void *viscosity = fem_system_effect(system, &fem_effect_viscosity);
  if (!effect) return STATUS_OK;
  ContactSystem *contact = fem_effect_contact_system(effect);
  const ContactEvaluation *evaluation;
  TRY(fem_effect_contact_evaluate(system, state, &evaluation));
  const int count = contact_system_layout(contact)->interface_count;
  memset(moments, 0, (size_t)count * sizeof *moments);
  add_patches(evaluation, moments);
  if (stick) TRY(add_friction(stick, state, evaluation, moments));
  if (viscosity) TRY(fem_effect_viscosity_add_moments(viscosity, state, moments));
  for (int i = 0; i < count; i++) {
    const ContactInterface *interface = &evaluation->interfaces[i];
    if (interface->a == interface->b)
      vec3_store(moments[i], (Vec3){0, 0, 0});
    else if (contact_system_is_resting(contact, i) && !isnan(interface->centre[0]))
      vec3_store(moments[i], vec3_cross(vec3_at(interface->centre), vec3_at(interface->force)));
  }
  return STATUS_OK;
}
