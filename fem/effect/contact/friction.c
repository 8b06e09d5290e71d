// SPDX-License-Identifier: GPL-3.0-or-later
// Friction as an effect: contact/friction/friction.h on the system of the contact effect.
#include "fem/effect/contact/friction.h"

#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/sink.h"
#include "fem/effect/system.h"
#include "fem/model/compliance.h"
#include "fem/model/tolerance.h"

typedef struct Friction {
  const FemModel *model;  // borrowed
  ContactSystem *contact; // borrowed
  ContactFriction law;
} Friction;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on && fem_scene_most_friction(&scene->contact) > 0 &&
         fem_scene_friction_law(&scene->contact) == FEM_FRICTION_VELOCITY;
}

static Status create(void **self, const FemModel *model) {
  Friction *friction = memory_zeroed(1, sizeof *friction);
  if (!friction) return status_no_memory("friction");
  friction->model = model;
  *self = friction;
  return STATUS_OK;
}

static Status connect(void *self, const FemSystem *system) {
  Friction *friction = self;
  friction->contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  TRY(contact_friction_create(&friction->law, friction->contact, friction->model->scene->contact.friction,
                              fem_model_slip_speed(friction->model)));
  int count;
  const ContactInterface *interfaces = contact_system_interfaces(friction->contact, &count);
  for (int i = 0; i < count; i++)
    friction->law.coefficients[i] =
        fem_compliance_friction(friction->model, interfaces[i].a, interfaces[i].b);
  return STATUS_OK;
}

static void destroy(void *self) {
  Friction *friction = self;
  contact_friction_destroy(&friction->law);
  memory_free(friction);
}

static Status start(void *self, const FemState *state, FemEffectHistory *history) {
  (void)history;
  Friction *friction = self;
  double energy;
  TRY(contact_system_eval(friction->contact, state->time, state->positions, &energy, NULL));
  return contact_friction_update(&friction->law);
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  (void)state;
  const ContactFriction *law = &((Friction *)self)->law;
  for (int g = 0; g < law->grip_count; g++)
    TRY(fem_pattern_add_clique(pattern, law->grips[g].count, law->vertices + law->grips[g].begin, has_grown));
  return STATUS_OK;
}

static Status add_force(void *self, const FemState *state, double *force) {
  contact_friction_add_force(&((Friction *)self)->law, state->velocities, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)stiffness_scale; // normals and normal forces are those of the last accepted state
  if (damping_scale == 0) return STATUS_OK;
  FemContactSink sink = {.matrix = matrix, .scale = damping_scale};
  const ContactStiffnessSink to = fem_contact_sink_of(&sink);
  contact_friction_add_damping(&((Friction *)self)->law, state->velocities, &to);
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  ContactFrictionPower power = contact_friction_power(&((Friction *)self)->law, state->velocities);
  energy->dissipated_power += power.dissipated;
  energy->driven_power += power.driven;
  return STATUS_OK;
}

static void report(void *self, const FemState *state, Record *counters) {
  (void)state;
  const ContactFriction *law = &((Friction *)self)->law;
  record_add(counters, "friction_updates", law->updates);
  record_add(counters, "friction_pairs", law->taken);
  record_add(counters, "friction_pairs_dropped", law->dropped);
}

static size_t bytes(const void *self) {
  return memory_held(self) + contact_friction_bytes(&((const Friction *)self)->law);
}

const FemEffectOps fem_effect_friction = {
    .name = "friction",
    .help = "contacts resist sliding with up to μ times the normal force",
    .dissipates = true,
    .lags = true,
    .couples_anew = true,
    .is_wanted = is_wanted,
    .static_refusal = "the friction law velocity has no force at rest: in a static scene write "
                      "contact.potential: field and "
                      "contact.friction.law: stick, or remove contact.friction or time.static",
    .static_key = "contact.friction",
    .create = create,
    .connect = connect,
    .couple = couple,
    .start = start,
    .advance = start,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .report = report,
    .bytes = bytes,
    .destroy = destroy,
};

const ContactFriction *fem_effect_friction_of(const void *effect) {
  return &((const Friction *)effect)->law;
}
