// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/effect/friction.h"

#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"

Status fem_friction_create(FemFriction *friction, const FemSystem *system) {
  const ContactSystem *contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  size_t values = 3 * (size_t)system->model->vertex_count;
  int count = contact_system_layout(contact)->interface_count;
  *friction = (FemFriction){.effect = fem_system_effect(system, &fem_effect_stick),
                            .value_count = values,
                            .interface_count = count,
                            .now = memory_zeroed(values, sizeof(double)),
                            .then = memory_zeroed(values, sizeof(double)),
                            .scaled = memory_zeroed(values, sizeof(double)),
                            .stiffness = memory_zeroed((size_t)count, sizeof(double)),
                            .slip = memory_zeroed((size_t)count, sizeof(double)),
                            .moves = memory_zeroed((size_t)count, sizeof *friction->moves)};
  bool fits = friction->now && friction->then && friction->scaled && friction->stiffness && friction->slip &&
              friction->moves;
  return fits ? STATUS_OK : status_no_memory("derivatives of friction");
}

void fem_friction_destroy(FemFriction *friction) {
  memory_free(friction->now);
  memory_free(friction->then);
  memory_free(friction->scaled);
  memory_free(friction->before);
  memory_free(friction->stiffness);
  memory_free(friction->slip);
  memory_free(friction->moves);
  *friction = (FemFriction){0};
}

static int place_of(const FemFriction *friction) {
  return fem_effect_stick_place(friction->effect);
}

static ContactStickHistory last_of(const FemFriction *friction) {
  return fem_effect_stick_history(friction->effect, &friction->state->last->histories[place_of(friction)]);
}

Status fem_friction_begin(FemFriction *friction, const FemState *state) {
  size_t interfaces = (size_t)friction->interface_count;
  friction->state = state;
  size_t entries = (size_t)last_of(friction).entry_count;
  if (!memory_reserve((void **)&friction->before, &friction->before_capacity, entries + 1,
                      sizeof *friction->before))
    return status_no_memory("derivatives of friction");
  memset(friction->before, 0, entries * sizeof *friction->before);
  memset(friction->now, 0, friction->value_count * sizeof(double));
  memset(friction->then, 0, friction->value_count * sizeof(double));
  memset(friction->stiffness, 0, interfaces * sizeof(double));
  memset(friction->slip, 0, interfaces * sizeof(double));
  memset(friction->moves, 0, interfaces * sizeof *friction->moves);
  return STATUS_OK;
}

static ContactStickPull pull_of(const FemFriction *friction) {
  return (ContactStickPull){.interface = CONTACT_ALL_INTERFACES,
                            .now = friction->now,
                            .then = friction->then,
                            .before = friction->before,
                            .stiffness = friction->stiffness,
                            .friction = friction->slip,
                            .answers = friction->answers,
                            .moves = friction->moves};
}

Status fem_friction_pull(FemFriction *friction, int interface, const double *forces, double weight) {
  ContactStickPull pull = pull_of(friction);
  pull.interface = interface;
  for (size_t i = 0; i < friction->value_count; i++) friction->scaled[i] = weight * forces[i];
  pull.forces = friction->scaled;
  return fem_effect_stick_pull(friction->effect, friction->state, &pull);
}

Status fem_friction_pull_history(FemFriction *friction, const FemEffectHistory *next,
                                 const double (*after)[3]) {
  ContactStickPull pull = pull_of(friction);
  const ContactStickHistory history = fem_effect_stick_history(friction->effect, next);
  pull.next = &history;
  pull.after = after;
  return fem_effect_stick_pull(friction->effect, friction->state, &pull);
}

Status fem_friction_add_force(const FemFriction *friction, int interface, double *force) {
  const ContactStick *law;
  TRY(fem_effect_stick_evaluate(friction->effect, friction->state, &law));
  contact_stick_add_force_of(law, interface, force);
  return STATUS_OK;
}
