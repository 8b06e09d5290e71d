// SPDX-License-Identifier: GPL-3.0-or-later
// Friction by elastic stick as an effect: contact/friction/stick.h on the system of the contact effect. Its
// forces depend on positions and on the last accepted state, which `prepare` moves on.
#include "fem/effect/contact/stick.h"

#include <string.h>

#include "base/memory.h"
#include "contact/friction/stick_pairs.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/sink.h"
#include "fem/effect/system.h"
#include "fem/model/compliance.h"

typedef struct Stick {
  const FemModel *model;  // borrowed
  ContactSystem *contact; // borrowed
  ContactStick law;
  bool *is_resting;     // each interface                            (law.interface_count)
  bool has_begun;       // there is a state from which gaps count
  double time;          // of that [s]
  long long evaluation; // of the contact system that the law was evaluated for; −1: none
  long long accepted;   // states
} Stick;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on && fem_scene_most_friction(&scene->contact) > 0 &&
         fem_scene_friction_law(&scene->contact) == FEM_FRICTION_STICK;
}

static Status create(void **self, const FemModel *model) {
  Stick *stick = memory_zeroed(1, sizeof *stick);
  if (!stick) return status_no_memory("friction");
  stick->model = model;
  stick->evaluation = -1;
  *self = stick;
  return STATUS_OK;
}

static Status create_law(Stick *stick, int count, double *coefficients, ContactStickLaw *laws) {
  const FemModel *model = stick->model;
  const ContactInterface *interfaces = contact_system_interfaces(stick->contact, &count);
  for (int i = 0; i < count; i++)
    coefficients[i] = fem_compliance_friction(model, interfaces[i].a, interfaces[i].b);
  contact_stick_pairs_laws(stick->contact, coefficients, laws);
  const ContactSystemDef *def = &contact_system_layout(stick->contact)->def;
  TRY(contact_stick_create(&stick->law, def->vertex_count, def->rest, def->tets, count, laws));
  stick->law.stars = contact_system_stars(stick->contact);
  return STATUS_OK;
}

static Status connect(void *self, const FemSystem *system) {
  Stick *stick = self;
  int count;
  stick->contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  contact_system_interfaces(stick->contact, &count);
  stick->is_resting = memory_zeroed((size_t)count, sizeof *stick->is_resting);
  double *coefficients = memory_zeroed((size_t)count, sizeof *coefficients);
  ContactStickLaw *laws = memory_zeroed((size_t)count, sizeof *laws);
  bool has_room = stick->is_resting && coefficients && laws;
  Status status = has_room ? create_law(stick, count, coefficients, laws) : status_no_memory("friction");
  memory_free(coefficients);
  memory_free(laws);
  return status;
}

static void destroy(void *self) {
  Stick *stick = self;
  contact_stick_destroy(&stick->law);
  memory_free(stick->is_resting);
  memory_free(stick);
}

// The friction at a state; once for each evaluation of the contact system.
static Status evaluate(Stick *stick, const FemState *state) {
  double energy;
  TRY(contact_system_eval(stick->contact, state->time, state->positions, &energy, NULL));
  long long evaluation = contact_system_counters(stick->contact)->evaluations;
  if (stick->evaluation == evaluation) return STATUS_OK;
  TRY(contact_stick_pairs_eval(&stick->law, stick->contact, stick->time, stick->is_resting));
  stick->evaluation = evaluation;
  return STATUS_OK;
}

static Status begin(void *self, const FemState *state) {
  Stick *stick = self;
  contact_stick_begin(&stick->law, contact_system_place(stick->contact, state->positions));
  stick->has_begun = true;
  stick->time = state->time;
  stick->evaluation = -1;
  return STATUS_OK;
}

// A state is accepted once, or its history would be rounded anew each time.
static bool is_at_last(const Stick *stick, const FemState *state) {
  size_t bytes = 3 * (size_t)stick->law.vertex_count * sizeof(double);
  return state->time == stick->time &&
         memcmp(contact_system_place(stick->contact, state->positions), stick->law.before, bytes) == 0;
}

static Status prepare(void *self, const FemState *state, double step) {
  (void)step;
  Stick *stick = self;
  if (!stick->has_begun) return begin(self, state);
  if (is_at_last(stick, state)) return STATUS_OK;
  TRY(evaluate(stick, state));
  TRY(contact_stick_accept(&stick->law, contact_system_place(stick->contact, state->positions),
                           stick->is_resting));
  stick->time = state->time;
  stick->evaluation = -1;
  stick->accepted++;
  return STATUS_OK;
}

typedef struct Coupling {
  ContactSystem *contact;
  FemPattern *pattern;
  int *has_grown;
} Coupling;

static Status add_clique(void *visitor, int count, const int *vertices) {
  Coupling *coupling = visitor;
  contact_system_carriers(coupling->contact, &count, &vertices);
  return fem_pattern_add_clique(coupling->pattern, count, vertices, coupling->has_grown);
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  Stick *stick = self;
  TRY(evaluate(stick, state));
  Coupling coupling = {.contact = stick->contact, .pattern = pattern, .has_grown = has_grown};
  return contact_stick_couple(&stick->law, &coupling, add_clique);
}

static Status add_force(void *self, const FemState *state, double *force) {
  Stick *stick = self;
  TRY(evaluate(stick, state));
  contact_stick_add_force(&stick->law, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale; // it depends on positions only
  Stick *stick = self;
  if (stiffness_scale == 0) return STATUS_OK;
  TRY(evaluate(stick, state));
  FemContactSink sink = {.matrix = matrix, .scale = stiffness_scale};
  const ContactStiffnessSink to = fem_contact_sink_of(&sink);
  return contact_stick_add_stiffness(&stick->law, contact_system_sink(stick->contact, &to));
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  Stick *stick = self;
  TRY(evaluate(stick, state));
  energy->contact += stick->law.stored;
  energy->friction_work += stick->law.dissipated + stick->law.spent;
  energy->driven_power += contact_stick_pairs_shape_power(&stick->law, stick->contact);
  energy->turned_power += contact_stick_pairs_turned_power(&stick->law, stick->contact, state->velocities);
  return STATUS_OK;
}

static void report(void *self, Record *counters) {
  const Stick *stick = self;
  record_add(counters, "friction_updates", stick->accepted);
  record_integer(counters, "friction_vertices", stick->law.node_count);
  record_integer(counters, "friction_slipping", stick->law.slip_count);
  record_number(counters, "friction_work", stick->law.dissipated);
}

// What was dissipated, the forces and areas by interface, of which those at rest are still told, and the
// history.
static Status save(const void *self, double **values, size_t *count) {
  const ContactStick *law = &((const Stick *)self)->law;
  size_t forces = 3 * (size_t)law->interface_count, areas = 2 * (size_t)law->interface_count, entries;
  double *history;
  TRY(contact_stick_history_save(&law->history, &history, &entries));
  *count = 1 + forces + areas + entries;
  *values = memory_zeroed(*count, sizeof **values);
  if (*values) {
    (*values)[0] = law->dissipated;
    memcpy(*values + 1, law->forces, forces * sizeof **values);
    memcpy(*values + 1 + forces, law->areas, areas * sizeof **values);
    memcpy(*values + 1 + forces + areas, history, entries * sizeof **values);
  }
  memory_free(history);
  return *values ? STATUS_OK : status_no_memory("a checkpoint");
}

static Status load(void *self, const double *values, size_t count) {
  ContactStick *law = &((Stick *)self)->law;
  size_t forces = 3 * (size_t)law->interface_count, areas = 2 * (size_t)law->interface_count,
         own = 1 + forces + areas;
  if (count < own)
    return status_fail(STATUS_INPUT, "the checkpoint has friction of another scene: %zu numbers, not %zu",
                       count, own);
  law->dissipated = values[0];
  memcpy(law->forces, values + 1, forces * sizeof *values);
  memcpy(law->areas, values + 1 + forces, areas * sizeof *values);
  return contact_stick_history_load(&law->history, values + own, count - own, law->interface_count,
                                    law->vertex_count);
}

static size_t bytes(const void *self) {
  const Stick *stick = self;
  return memory_held(self) + memory_held(stick->is_resting) + contact_stick_bytes(&stick->law);
}

const FemEffectOps fem_effect_stick = {
    .name = "stick",
    .help = "contacts stick by a spring in the tangent plane that slips at μ times the normal force",
    .is_wanted = is_wanted,
    .create = create,
    .connect = connect,
    .begin = begin,
    .couple = couple,
    .prepare = prepare,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .report = report,
    .save = save,
    .load = load,
    .bytes = bytes,
    .destroy = destroy,
};

const ContactStick *fem_effect_stick_of(const void *effect) {
  return &((const Stick *)effect)->law;
}
