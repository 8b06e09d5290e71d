// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/forces.h"

#include <math.h>
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

static Status create_slip(FemForces *forces) {
  size_t vertices = (size_t)forces->system->model->vertex_count;
  forces->slip = memory_zeroed(values_of(forces), sizeof *forces->slip);
  forces->way = memory_zeroed(vertices, sizeof *forces->way);
  forces->work = memory_zeroed(vertices, sizeof *forces->work);
  forces->stuck = memory_zeroed(vertices, sizeof *forces->stuck);
  return forces->slip && forces->way && forces->work && forces->stuck ? STATUS_OK
                                                                      : status_no_memory("the slip");
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
  forces->gap = memory_zeroed(vertices, sizeof *forces->gap);
  forces->status = memory_zeroed(vertices, sizeof *forces->status);
  if (!forces->pressure || !forces->depth || !forces->traction || !forces->gap || !forces->status)
    return status_no_memory("the contact forces");
  return has_friction ? create_slip(forces) : STATUS_OK;
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
  memory_free(forces->gap);
  memory_free(forces->status);
  memory_free(forces->slip);
  memory_free(forces->way);
  memory_free(forces->work);
  memory_free(forces->stuck);
  *forces = (FemForces){0};
}

static void take_interfaces(FemForces *forces, const ContactInterface *interfaces) {
  for (int i = 0; i < forces->interface_count; i++) {
    vec3_store(forces->interfaces[i], vec3_at(interfaces[i].force));
    vec3_store(forces->centres[i], vec3_at(interfaces[i].centre));
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

Status fem_forces_take_areas(FemForces *forces, const FemState *state) {
  const ContactEvaluation *evaluation;
  TRY(fem_effect_contact_evaluate(forces->system, state, &evaluation));
  if (evaluation) contact_system_areas(contact_of(forces->system), evaluation, forces->areas);
  return STATUS_OK;
}

static Status take_slip(FemForces *forces, void *stick, const FemState *state) {
  size_t vertices = (size_t)forces->system->model->vertex_count;
  memset(forces->slip, 0, 3 * vertices * sizeof *forces->slip);
  memset(forces->way, 0, vertices * sizeof *forces->way);
  memset(forces->work, 0, vertices * sizeof *forces->work);
  memset(forces->stuck, 0, vertices * sizeof *forces->stuck);
  return fem_effect_stick_tell(stick, state,
                               &(ContactStickTold){.weights = forces->stuck,
                                                   .slips = (double(*)[3])forces->slip,
                                                   .ways = forces->way,
                                                   .works = forces->work});
}

// Without friction what touches slides.
static FemContactStatus status_at(const FemForces *forces, int v) {
  if (!(forces->pressure[v] > 0)) return FEM_CONTACT_OPEN;
  if (!forces->stuck || forces->stuck[v][1] > forces->stuck[v][0]) return FEM_CONTACT_SLIDES;
  return FEM_CONTACT_STICKS;
}

static void take_status(FemForces *forces, const ContactEvaluation *evaluation) {
  contact_system_gaps(contact_of(forces->system), evaluation, forces->gap);
  for (int v = 0; v < forces->system->model->vertex_count; v++) {
    if (forces->depth[v] > 0) forces->gap[v] = -forces->depth[v];
    if (!isfinite(forces->gap[v])) forces->gap[v] = NAN;
    forces->status[v] = status_at(forces, v);
    if (forces->slip && forces->status[v] == FEM_CONTACT_OPEN)
      vec3_store(forces->slip + 3 * (size_t)v, (Vec3){0, 0, 0});
  }
}

Status fem_forces_take_surface(FemForces *forces, const FemState *state) {
  void *stick = fem_system_effect(forces->system, &fem_effect_stick);
  const ContactEvaluation *evaluation;
  const ContactStick *law = NULL;
  if (!forces->pressure) return STATUS_OK;
  TRY(fem_effect_contact_evaluate(forces->system, state, &evaluation));
  if (stick) TRY(fem_effect_stick_evaluate(stick, state, &law));
  TRY(contact_system_trace(contact_of(forces->system), evaluation,
                           law ? (const double(*)[3])law->pulls : NULL,
                           &(ContactTraceResult){.pressures = forces->pressure,
                                                 .depths = forces->depth,
                                                 .tractions = (double(*)[3])forces->traction}));
  if (stick) TRY(take_slip(forces, stick, state));
  take_status(forces, evaluation);
  return STATUS_OK;
}
