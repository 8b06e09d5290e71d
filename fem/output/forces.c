// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/forces.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/friction.h"
#include "fem/effect/contact/stick.h"
#include "fem/effect/contact/viscosity.h"

bool fem_forces_has_friction(const FemSystem *system) {
  return fem_system_effect(system, &fem_effect_friction) || fem_system_effect(system, &fem_effect_stick);
}

bool fem_forces_has_stick(const FemSystem *system) {
  return fem_system_effect(system, &fem_effect_stick) != NULL;
}

static ContactSystem *contact_of(const FemSystem *system) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  return effect ? fem_effect_contact_system(effect) : NULL;
}

static size_t values_of(const FemForces *forces) {
  return 3 * (size_t)forces->system->model->vertex_count;
}

static Status create_at(FemForcesAt *at, const FemForces *forces, bool with_vertices) {
  at->interfaces = memory_zeroed((size_t)forces->interface_count, sizeof *at->interfaces);
  at->areas = memory_zeroed((size_t)forces->interface_count, sizeof *at->areas);
  at->centres = memory_zeroed((size_t)forces->interface_count, sizeof *at->centres);
  if (!at->interfaces || !at->areas || !at->centres) return status_no_memory("the contact forces");
  bool rubs = fem_forces_has_friction(forces->system);
  if (rubs) at->rubbing = memory_zeroed((size_t)forces->interface_count, sizeof *at->rubbing);
  if (rubs && !at->rubbing) return status_no_memory("the contact forces");
  if (!with_vertices) return STATUS_OK;
  at->contact = memory_zeroed(values_of(forces), sizeof *at->contact);
  size_t vertices = (size_t)forces->system->model->vertex_count;
  if (forces->system->model->scene->contact.potential == CONTACT_POTENTIAL_FIELD) {
    at->pressure = memory_zeroed(vertices, sizeof *at->pressure);
    at->depth = memory_zeroed(vertices, sizeof *at->depth);
    if (!at->pressure || !at->depth) return status_no_memory("the contact forces");
  }
  if (rubs) at->friction = memory_zeroed(values_of(forces), sizeof *at->friction);
  return at->contact && (!rubs || at->friction) ? STATUS_OK : status_no_memory("the contact forces");
}

Status fem_forces_create(FemForces *forces, const FemSystem *system, bool with_vertices) {
  *forces = (FemForces){.system = system};
  ContactSystem *contact = contact_of(system);
  if (!contact) return STATUS_OK;
  contact_system_interfaces(contact, &forces->interface_count);
  TRY(create_at(&forces->begin, forces, with_vertices));
  TRY(create_at(&forces->end, forces, with_vertices));
  return create_at(&forces->now, forces, with_vertices);
}

static void destroy_at(FemForcesAt *at) {
  memory_free(at->interfaces);
  memory_free(at->areas);
  memory_free(at->centres);
  memory_free(at->contact);
  memory_free(at->friction);
  memory_free(at->rubbing);
  memory_free(at->pressure);
  memory_free(at->depth);
}

void fem_forces_destroy(FemForces *forces) {
  destroy_at(&forces->begin);
  destroy_at(&forces->end);
  destroy_at(&forces->now);
  *forces = (FemForces){0};
}

static void take_rubbing(const FemSystem *system, int count, FemRubbing *rubbing) {
  void *friction = fem_system_effect(system, &fem_effect_friction),
       *stick = fem_system_effect(system, &fem_effect_stick);
  const ContactStick *law = stick ? fem_effect_stick_of(stick) : NULL;
  for (int i = 0; i < count; i++) {
    rubbing[i] = (FemRubbing){0};
    if (friction) vec3_store(rubbing[i].force, vec3_at(fem_effect_friction_of(friction)->forces[i]));
    if (!law) continue;
    vec3_store(rubbing[i].force, vec3_at(law->forces[i]));
    rubbing[i].stuck = law->areas[i][0];
    rubbing[i].slides = law->areas[i][1];
  }
}

// From the state that was evaluated last.
static Status take(const FemForces *forces, FemForcesAt *at, double time) {
  const FemSystem *system = forces->system;
  void *friction = fem_system_effect(system, &fem_effect_friction),
       *stick = fem_system_effect(system, &fem_effect_stick),
       *viscosity = fem_system_effect(system, &fem_effect_viscosity);
  ContactSystem *contact = contact_of(system);
  int count;
  const ContactInterface *interfaces = contact_system_interfaces(contact, &count);
  at->time = time;
  for (int i = 0; i < count; i++) {
    vec3_store(at->interfaces[i], vec3_at(interfaces[i].force));
    vec3_store(at->centres[i], vec3_at(interfaces[i].centre));
    at->areas[i] = interfaces[i].area;
    if (friction) vec3_accumulate(at->interfaces[i], vec3_at(fem_effect_friction_of(friction)->forces[i]));
    if (stick) vec3_accumulate(at->interfaces[i], vec3_at(fem_effect_stick_of(stick)->forces[i]));
  }
  if (viscosity) fem_effect_viscosity_add(viscosity, system->velocities, at->interfaces, NULL);
  if (at->rubbing) take_rubbing(system, count, at->rubbing);
  if (at->contact) memcpy(at->contact, contact_system_forces(contact), values_of(forces) * sizeof(double));
  if (at->contact && viscosity) fem_effect_viscosity_add(viscosity, system->velocities, NULL, at->contact);
  if (at->pressure) TRY(contact_system_trace(contact, at->pressure, at->depth));
  if (!at->friction) return STATUS_OK;
  memset(at->friction, 0, values_of(forces) * sizeof *at->friction);
  if (friction)
    contact_friction_add_force(fem_effect_friction_of(friction), system->velocities, at->friction);
  if (stick) contact_stick_add_force(fem_effect_stick_of(stick), at->friction);
  return STATUS_OK;
}

Status fem_forces_begin(FemForces *forces, double time) {
  if (!forces->now.interfaces) return STATUS_OK;
  TRY(take(forces, &forces->begin, time));
  forces->has_begin = true;
  forces->has_end = false;
  return STATUS_OK;
}

Status fem_forces_end(FemForces *forces, double time) {
  if (!forces->now.interfaces) return STATUS_OK;
  TRY(take(forces, &forces->end, time));
  forces->has_end = true;
  return STATUS_OK;
}

void fem_forces_accept(FemForces *forces) {
  if (!forces->has_end) return;
  FemForcesAt begin = forces->begin;
  forces->begin = forces->end;
  forces->end = begin;
  forces->has_begin = true;
  forces->has_end = false;
}

// Where one of the two is not known the other stands.
static void mix(size_t count, double share, const double *begin, const double *end, double *now) {
  for (size_t k = 0; k < count; k++)
    now[k] = isnan(begin[k]) ? end[k] : isnan(end[k]) ? begin[k] : begin[k] + share * (end[k] - begin[k]);
}

Status fem_forces_set(FemForces *forces, double time) {
  const FemForcesAt *begin = &forces->begin, *end = &forces->end;
  FemForcesAt *now = &forces->now;
  if (!now->interfaces) return STATUS_OK;
  if (!forces->has_begin || !forces->has_end || !(end->time > begin->time)) return take(forces, now, time);
  double share = fmin(fmax((time - begin->time) / (end->time - begin->time), 0), 1);
  now->time = time;
  mix(3 * (size_t)forces->interface_count, share, begin->interfaces[0], end->interfaces[0],
      now->interfaces[0]);
  mix((size_t)forces->interface_count, share, begin->areas, end->areas, now->areas);
  mix(3 * (size_t)forces->interface_count, share, begin->centres[0], end->centres[0], now->centres[0]);
  if (now->rubbing)
    mix((size_t)forces->interface_count * sizeof *now->rubbing / sizeof(double), share,
        (const double *)begin->rubbing, (const double *)end->rubbing, (double *)now->rubbing);
  if (now->contact) mix(values_of(forces), share, begin->contact, end->contact, now->contact);
  if (now->friction) mix(values_of(forces), share, begin->friction, end->friction, now->friction);
  if (!now->pressure) return STATUS_OK;
  mix(values_of(forces) / 3, share, begin->pressure, end->pressure, now->pressure);
  mix(values_of(forces) / 3, share, begin->depth, end->depth, now->depth);
  return STATUS_OK;
}
