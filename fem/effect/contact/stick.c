// SPDX-License-Identifier: GPL-3.0-or-later
// Friction by elastic stick as an effect: contact/friction/stick.h on the system of the contact effect. Its
// forces depend on positions and on the last accepted state. Its history is contact/friction/stick_history.h.
#include "fem/effect/contact/stick.h"

#include "base/memory.h"
#include "contact/friction/stick_pairs.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/sink.h"
#include "fem/effect/system.h"
#include "fem/model/compliance/compliance.h"

typedef struct Stick {
  const FemModel *model;  // borrowed
  ContactSystem *contact; // borrowed
  ContactStick law;
  bool *is_resting;                // each interface                   (law.interface_count)
  int place;                       // of this effect in its system
  long long version, last_version; // of the state that the law was evaluated for, and of its last; 0: none
  long long accepted;              // states
} Stick;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on && fem_scene_most_friction(&scene->contact) > 0;
}

static Status create(void **self, const FemModel *model) {
  Stick *stick = memory_zeroed(1, sizeof *stick);
  if (!stick) return status_no_memory("friction");
  stick->model = model;
  *self = stick;
  return STATUS_OK;
}

// Its laws are copied.
static Status connect_to(Stick *stick, ContactSystem *contact, int place, const ContactStickLaw *laws) {
  const ContactSystemDef *def = &contact_system_layout(contact)->def;
  int count = contact_system_layout(contact)->interface_count;
  stick->place = place;
  stick->contact = contact;
  stick->is_resting = memory_zeroed((size_t)count, sizeof *stick->is_resting);
  if (!stick->is_resting) return status_no_memory("friction");
  TRY(contact_stick_create(&stick->law, def->vertex_count, def->rest, def->tets, count, laws));
  stick->law.stars = contact_system_stars(contact);
  return STATUS_OK;
}

static void choose_laws(const FemModel *model, const ContactSystem *contact, ContactStickLaw *laws) {
  const ContactLayout *layout = contact_system_layout(contact);
  for (int i = 0; i < layout->interface_count; i++) {
    const FemFrictionDef friction =
        fem_compliance_friction(model, layout->interfaces[i].a, layout->interfaces[i].b);
    laws[i] = (ContactStickLaw){
        .friction = friction.coefficient, .at_rest = friction.at_rest, .length = friction.length};
  }
  contact_stick_pairs_laws(contact, laws);
}

static Status connect(void *self, const FemSystem *system) {
  Stick *stick = self;
  ContactSystem *contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  ContactStickLaw *laws =
      memory_zeroed((size_t)contact_system_layout(contact)->interface_count, sizeof *laws);
  if (!laws) return status_no_memory("friction");
  choose_laws(stick->model, contact, laws);
  Status status = connect_to(stick, contact, fem_system_place(system, &fem_effect_stick), laws);
  memory_free(laws);
  return status;
}

static void destroy(void *self) {
  Stick *stick = self;
  contact_stick_destroy(&stick->law);
  memory_free(stick->is_resting);
  memory_free(stick);
}

Status fem_effect_stick_create_like(void **self, const FemModel *model, void *contact, const void *of) {
  const Stick *other = of;
  TRY(create(self, model));
  Status status = connect_to(*self, fem_effect_contact_system(contact), other->place, other->law.laws);
  if (status) destroy(*self);
  return status;
}

int fem_effect_stick_place(const void *effect) {
  return ((const Stick *)effect)->place;
}

ContactStickHistory fem_effect_stick_history(const void *effect, const FemEffectHistory *history) {
  const Stick *stick = effect;
  return contact_stick_history_view(stick->law.interface_count, history->values, history->count);
}

static ContactStickHistory history_of(const Stick *stick, const FemState *accepted) {
  return fem_effect_stick_history(stick, &accepted->histories[stick->place]);
}

// What it was at the last accepted state.
static ContactStickLast last_of(Stick *stick, const FemState *state) {
  return (ContactStickLast){.positions = contact_system_place(stick->contact, state->last->positions),
                            .history = history_of(stick, state->last)};
}

// The friction at a state, which is evaluated once, and the contact that it is of.
static Status evaluate(Stick *stick, const FemState *state, const ContactEvaluation **evaluation) {
  const FemState *last = state->last;
  TRY(contact_evaluate(stick->contact, state->version, state->time, state->positions, evaluation));
  if (stick->version == state->version && stick->last_version == last->version) return STATUS_OK;
  ContactStickLast before = last_of(stick, state);
  stick->version = 0;
  TRY(contact_stick_pairs_eval(&stick->law, stick->contact, *evaluation, &before, last->time,
                               stick->is_resting));
  stick->version = state->version;
  stick->last_version = last->version;
  return STATUS_OK;
}

static Status start(void *self, const FemState *state, FemEffectHistory *history) {
  (void)state;
  size_t count = contact_stick_history_count(((Stick *)self)->law.interface_count, 0);
  TRY(fem_effect_history_resize(history, count));
  for (size_t i = 0; i < count; i++) history->values[i] = 0;
  return STATUS_OK;
}

static Status advance(void *self, const FemState *state, FemEffectHistory *next) {
  Stick *stick = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  const ContactStickHistory history = history_of(stick, state->last);
  TRY(fem_effect_history_resize(next, contact_stick_next_count(&stick->law, &history, stick->is_resting)));
  contact_stick_advance(&stick->law, &history, stick->is_resting, next->values);
  stick->accepted++;
  return STATUS_OK;
}

static Status check_history(const void *self, const double *values, size_t count) {
  const ContactStick *law = &((const Stick *)self)->law;
  return contact_stick_history_check(law->interface_count, law->vertex_count, values, count);
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
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  Coupling coupling = {.contact = stick->contact, .pattern = pattern, .has_grown = has_grown};
  return contact_stick_couple(&stick->law, &coupling, add_clique);
}

static Status add_force(void *self, const FemState *state, double *force) {
  Stick *stick = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  contact_stick_add_force(&stick->law, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale; // it depends on positions only
  Stick *stick = self;
  if (stiffness_scale == 0) return STATUS_OK;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  FemContactSink sink = {.matrix = matrix, .scale = stiffness_scale};
  const ContactStiffnessSink to = fem_contact_sink_of(&sink);
  return contact_stick_add_stiffness(&stick->law, contact_system_sink(stick->contact, &to));
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  Stick *stick = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  energy->contact += stick->law.stored;
  energy->friction_work += *history_of(stick, state->last).dissipated + stick->law.spent;
  energy->driven_power +=
      contact_stick_pairs_shape_power(&stick->law, contact_system_layout(stick->contact), evaluation);
  energy->turned_power +=
      contact_stick_pairs_turned_power(&stick->law, stick->contact, evaluation, state->velocities);
  return STATUS_OK;
}

static void report(void *self, const FemState *state, Record *counters) {
  const Stick *stick = self;
  record_add(counters, "friction_updates", stick->accepted);
  record_integer(counters, "friction_vertices", stick->law.node_count);
  record_integer(counters, "friction_slipping", stick->law.slip_count);
  record_number(counters, "friction_work", *history_of(stick, state).dissipated);
}

static size_t bytes(const void *self) {
  const Stick *stick = self;
  return memory_held(self) + memory_held(stick->is_resting) + contact_stick_bytes(&stick->law);
}

const FemEffectOps fem_effect_stick = {
    .name = "stick",
    .help = "contacts stick by a spring in the tangent plane that slips at μ times the normal force",
    .couples_anew = true,
    .is_wanted = is_wanted,
    .create = create,
    .connect = connect,
    .couple = couple,
    .start = start,
    .advance = advance,
    .check_history = check_history,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .report = report,
    .bytes = bytes,
    .destroy = destroy,
};

Status fem_effect_stick_evaluate(void *effect, const FemState *state, const ContactStick **law) {
  Stick *stick = effect;
  const ContactEvaluation *evaluation;
  *law = &stick->law;
  return evaluate(stick, state, &evaluation);
}

Status fem_effect_stick_tell(void *effect, const FemState *state, const ContactStickTold *told) {
  Stick *stick = effect;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  const ContactStickHistory history = history_of(stick, state->last);
  contact_stick_tell(&stick->law, &history, stick->is_resting,
                     contact_system_layout(stick->contact)->mesh.depths, told);
  return STATUS_OK;
}

Status fem_effect_stick_pull(void *effect, const FemState *state, const ContactStickPull *pull) {
  Stick *stick = effect;
  const ContactEvaluation *evaluation;
  TRY(evaluate(stick, state, &evaluation));
  ContactStickLast last = last_of(stick, state);
  return contact_stick_pull(&stick->law, stick->contact, evaluation, &last, state->last->time, pull);
}
