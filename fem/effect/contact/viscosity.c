// SPDX-License-Identifier: GPL-3.0-or-later
// Viscous contact as an effect: contact/friction/viscosity.h on the system of the contact effect, whose
// couplings are its own.
#include "fem/effect/contact/viscosity.h"

#include "base/memory.h"
#include "contact/friction/viscosity.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/sink.h"
#include "fem/effect/system.h"

typedef struct Viscosity {
  const FemModel *model;  // borrowed
  ContactSystem *contact; // borrowed
  ContactViscosity law;
} Viscosity;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on && scene->contact.viscosity > 0;
}

static Status create(void **self, const FemModel *model) {
  Viscosity *viscosity = memory_zeroed(1, sizeof *viscosity);
  if (!viscosity) return status_no_memory("contact viscosity");
  viscosity->model = model;
  *self = viscosity;
  return STATUS_OK;
}

static Status connect(void *self, const FemSystem *system) {
  Viscosity *viscosity = self;
  viscosity->contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  return contact_viscosity_create(&viscosity->law, viscosity->contact,
                                  viscosity->model->scene->contact.viscosity);
}

static void destroy(void *self) {
  Viscosity *viscosity = self;
  memory_free(viscosity);
}

static Status find_motion(const Viscosity *viscosity, const FemState *state, ContactViscosityMotion *motion) {
  motion->velocities = state->velocities;
  return contact_evaluate(viscosity->contact, state->version, state->time, state->positions,
                          &motion->evaluation);
}

static Status add_force(void *self, const FemState *state, double *force) {
  Viscosity *viscosity = self;
  ContactViscosityMotion motion;
  TRY(find_motion(viscosity, state, &motion));
  contact_viscosity_add_force(&viscosity->law, motion, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)stiffness_scale;
  Viscosity *viscosity = self;
  FemContactSink sink = {.matrix = matrix, .scale = 1};
  const ContactStiffnessSink to = fem_contact_sink_of(&sink);
  ContactViscosityMotion motion;
  TRY(find_motion(viscosity, state, &motion));
  contact_viscosity_add_damping(&viscosity->law, motion, damping_scale, &to);
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  Viscosity *viscosity = self;
  ContactViscosityMotion motion;
  TRY(find_motion(viscosity, state, &motion));
  ContactViscosityPower power = contact_viscosity_power(&viscosity->law, motion);
  energy->dissipated_power += power.dissipated;
  energy->driven_power += power.driven;
  return STATUS_OK;
}

static size_t bytes(const void *self) {
  return memory_held(self);
}

const FemEffectOps fem_effect_viscosity = {
    .name = "contact_viscosity",
    .help = "penetration of another body is resisted in proportion to its speed",
    .dissipates = true,
    .is_wanted = is_wanted,
    .create = create,
    .connect = connect,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .bytes = bytes,
    .destroy = destroy,
};

Status fem_effect_viscosity_add(const void *effect, const FemState *state, double (*interfaces)[3],
                                double *vertices) {
  const Viscosity *viscosity = effect;
  ContactViscosityMotion motion;
  TRY(find_motion(viscosity, state, &motion));
  if (vertices) contact_viscosity_add_force(&viscosity->law, motion, vertices);
  if (interfaces) contact_viscosity_add_resultants(&viscosity->law, motion, interfaces);
  return STATUS_OK;
}

Status fem_effect_viscosity_add_moments(const void *effect, const FemState *state, double (*moments)[3]) {
  const Viscosity *viscosity = effect;
  ContactViscosityMotion motion;
  TRY(find_motion(viscosity, state, &motion));
  contact_viscosity_add_moments(&viscosity->law, motion, moments);
  return STATUS_OK;
}
