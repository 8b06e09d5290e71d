// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/forces.h"

#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/stick.h"
#include "fem/effect/contact/viscosity.h"

bool fem_forces_has_friction(const FemSystem *system) {
  return fem_system_effect(system, &fem_effect_stick) != NULL;
}

static ContactSystem *contact_of(const FemSystem *system) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  return effect ? fem_effect_contact_system(effect) : NULL;
}

static size_t values_of(const FemForces *forces) {
  return 3 * (size_t)forces->system->model->vertex_count;
}

static Status create_of_vertices(FemForces *forces, bool has_friction) {
  const FemModel *model = forces->system->model;
  size_t vertices = (size_t)model->vertex_count;
  forces->contact = memory_zeroed(values_of(forces), sizeof *forces->contact);
  if (has_friction) forces->friction = memory_zeroed(values_of(forces), sizeof *forces->friction);
  if (!forces->contact || (has_friction && !forces->friction)) return status_no_memory("the contact forces");
  if (model->scene->contact.potential != CONTACT_POTENTIAL_FIELD) return STATUS_OK;
  forces->pressure = memory_zeroed(vertices, sizeof *forces->pressure);
  forces->depth = memory_zeroed(vertices, sizeof *forces->depth);
  forces->traction = memory_zeroed(values_of(forces), sizeof *forces->traction);
  return forces->pressure && forces->depth && forces->traction ? STATUS_OK
                                                               : status_no_memory("the contact forces");
}

Status fem_forces_create(FemForces *forces, const FemSystem *system, bool with_vertices) {
  *forces = (FemForces){.system = system};
  ContactSystem *contact = contact_of(system);
  if (!contact) return STATUS_OK;
  forces->interface_count = contact_system_layout(contact)->interface_count;
  size_t count = (size_t)forces->interface_count;
  bool has_friction = fem_forces_has_friction(system);
  forces->interfaces = memory_zeroed(count, sizeof *forces->interfaces);
  forces->areas = memory_zeroed(count, sizeof *forces->areas);
  forces->centres = memory_zeroed(count, sizeof *forces->centres);
  if (has_friction) forces->rubbing = memory_zeroed(count, sizeof *forces->rubbing);
  if (!forces->interfaces || !forces->areas || !forces->centres || (has_friction && !forces->rubbing))
    return status_no_memory("the contact forces");
  return with_vertices ? create_of_vertices(forces, has_friction) : STATUS_OK;
}

void fem_forces_destroy(FemForces *forces) {
  memory_free(forces->interfaces);
  memory_free(forces->areas);
  memory_free(forces->centres);
  memory_free(forces->contact);
  memory_free(forces->friction);
  memory_free(forces->rubbing);
  memory_free(forces->pressure);
  memory_free(forces->depth);
  memory_free(forces->traction);
  *forces = (FemForces){0};
}

static void take_interfaces(FemForces *forces, const ContactInterface *interfaces) {
  for (int i = 0; i < forces->interface_count; i++) {
    vec3_store(forces->interfaces[i], vec3_at(interfaces[i].force));
    vec3_store(forces->centres[i], vec3_at(interfaces[i].centre));
    forces->areas[i] = interfaces[i].area;
  }
}

static Status take_friction(FemForces *forces, const FemState *state) {
  void *stick = fem_system_effect(forces->system, &fem_effect_stick);
  const ContactStick *law;
  if (!stick) return STATUS_OK;
  TRY(fem_effect_stick_evaluate(stick, state, &law));
  for (int i = 0; i < forces->interface_count; i++) {
    FemRubbing *rubbing = &forces->rubbing[i];
    vec3_store(rubbing->force, vec3_at(law->forces[i]));
    rubbing->stuck = law->areas[i][0];
    rubbing->slides = law->areas[i][1];
    vec3_accumulate(forces->interfaces[i], vec3_at(rubbing->force));
  }
  if (!forces->friction) return STATUS_OK;
  memset(forces->friction, 0, values_of(forces) * sizeof *forces->friction);
  contact_stick_add_force(law, forces->friction);
  return STATUS_OK;
}

Status fem_forces_take(FemForces *forces, const FemState *state) {
  const FemSystem *system = forces->system;
  void *viscosity = fem_system_effect(system, &fem_effect_viscosity);
  const ContactEvaluation *evaluation;
  TRY(fem_effect_contact_evaluate(system, state, &evaluation));
  if (!evaluation) return STATUS_OK;
  take_interfaces(forces, evaluation->interfaces);
  if (forces->contact)
    memcpy(forces->contact, evaluation->given_forces, values_of(forces) * sizeof *forces->contact);
  TRY(take_friction(forces, state));
  if (viscosity) TRY(fem_effect_viscosity_add(viscosity, state, forces->interfaces, forces->contact));
  return STATUS_OK;
}

Status fem_forces_take_surface(FemForces *forces, const FemState *state) {
  void *stick = fem_system_effect(forces->system, &fem_effect_stick);
  const ContactEvaluation *evaluation;
  const ContactStick *law = NULL;
  if (!forces->pressure) return STATUS_OK;
  TRY(fem_effect_contact_evaluate(forces->system, state, &evaluation));
  if (stick) TRY(fem_effect_stick_evaluate(stick, state, &law));
  return contact_system_trace(contact_of(forces->system), evaluation,
                              law ? (const double(*)[3])law->pulls : NULL,
                              &(ContactTraceResult){.pressures = forces->pressure,
                                                    .depths = forces->depth,
                                                    .tractions = (double(*)[3])forces->traction});
}
