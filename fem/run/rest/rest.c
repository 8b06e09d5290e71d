// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/rest/rest.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/tolerance.h"
#include "fem/scene/drive.h"

struct FemRest {
  FemSystem *system;             // borrowed
  const FemModel *model;         // borrowed
  ContactSystem *contact;        // borrowed
  int body_count;                // with unknowns
  int party_count;               // bodies and mesh obstacles, then obstacles without elements
  bool *is_held;                 // asleep, or an obstacle that stands still     (party_count)
  double *calm_since;            // INFINITY: it is not calm [s]                 (body_count)
  double next_change;            // of what is held, while a body sleeps [s]
  bool has_changed, is_restored; // of bodies asleep; by a checkpoint, not yet passed to contact
  double *before;                // velocities at the state before [m/s]        (vertex_count, 3)
  double before_time;            // [s]; NAN: there is none
  double decided_at;             // the last time that was decided for [s]; NAN: none
  // Scratch memory.
  int *root;       // union–find                                          (party_count)
  bool *next_held; //                                                     (party_count)
  unsigned char *state;
  bool *is_balanced; //                                                   (body_count)
  // What happened; the last two of the whole run.
  long long sleeps, wakes;
  double asleep_s, lost; // bodies' time asleep, summed [s]; kinetic energy [J]
};

// Marks of a body, or of an island if one of its bodies has it.
enum { IS_AWAKE = 1, IS_UNREADY = 2, IS_DISTURBED = 1 << 2 };

bool fem_rest_is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on && scene->contact.rest_is_on && !scene->is_static;
}

void fem_rest_destroy(FemRest *rest) {
  if (!rest) return;
  memory_free(rest->is_held);
  memory_free(rest->calm_since);
  memory_free(rest->before);
  memory_free(rest->root);
  memory_free(rest->next_held);
  memory_free(rest->state);
  memory_free(rest->is_balanced);
  memory_free(rest);
}

Status fem_rest_create(FemRest **made, FemSystem *system) {
  FemRest *rest = memory_zeroed(1, sizeof *rest);
  if (!rest) return status_no_memory("bodies at rest");
  const FemModel *model = system->model;
  rest->system = system;
  rest->model = model;
  rest->contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  rest->body_count = model->scene->body_count;
  rest->party_count = model->body_count + fem_scene_shape_count(model->scene);
  size_t parties = (size_t)rest->party_count, values = 3 * (size_t)model->vertex_count;
  rest->is_held = memory_zeroed(parties, sizeof *rest->is_held);
  rest->next_held = memory_zeroed(parties, sizeof *rest->next_held);
  rest->root = memory_zeroed(parties, sizeof *rest->root);
  rest->state = memory_zeroed(parties, sizeof *rest->state);
  rest->calm_since = memory_zeroed((size_t)rest->body_count, sizeof *rest->calm_since);
  rest->is_balanced = memory_zeroed((size_t)rest->body_count, sizeof *rest->is_balanced);
  rest->before = memory_zeroed(values, sizeof *rest->before);
  rest->next_change = INFINITY;
  rest->before_time = rest->decided_at = NAN;
  for (int b = 0; b < rest->body_count && rest->calm_since; b++) rest->calm_since[b] = INFINITY;
  bool fits = rest->is_held && rest->next_held && rest->root && rest->state && rest->calm_since &&
              rest->before && rest->is_balanced;
  if (!fits) {
    fem_rest_destroy(rest);
    return status_no_memory("bodies at rest");
  }
  *made = rest;
  return STATUS_OK;
}

// ---- What changes, and when: `time` itself if it is changing.

static double next_release(const FemConstraintDef *def, double time) {
  return def->release > time ? def->release : INFINITY;
}

static double next_change_of_body(const FemRest *rest, int body, double time) {
  const FemBodyDef *def = &rest->model->scene->bodies[body];
  double next = INFINITY;
  for (int i = 0; i < def->fixed_count; i++) next = fmin(next, next_release(&def->fixed[i], time));
  for (int i = 0; i < def->driven_count; i++) {
    const FemConstraintDef *driven = &def->driven[i];
    bool is_free = driven->release > 0 && driven->release <= time;
    if (!is_free) next = fmin(next, fmin(next_release(driven, time), fem_drive_next_change(driven, time)));
  }
  for (int i = 0; i < def->load_count; i++) next = fmin(next, fem_load_next_change(&def->loads[i], time));
  return next;
}

// The obstacle that is that party.
static const FemObstacleDef *obstacle_of(const FemRest *rest, int party) {
  const FemSceneDef *scene = rest->model->scene;
  int mesh = rest->body_count, shape = rest->model->body_count;
  for (int o = 0; o < scene->obstacle_count; o++)
    if ((scene->obstacles[o].kind == FEM_OBSTACLE_MESH ? mesh++ : shape++) == party)
      return &scene->obstacles[o];
  return NULL;
}

static double next_change(const FemRest *rest, int party, double time) {
  if (party < rest->body_count) return next_change_of_body(rest, party, time);
  return fem_drive_next_change(&obstacle_of(rest, party)->motion, time);
}

// ---- Which bodies are calm.

static double fastest(const FemModelBody *body, const double *velocities) {
  double largest = 0;
  for (size_t v = (size_t)body->vertex_begin; v < (size_t)body->vertex_end; v++) {
    Vec3 velocity = vec3_at(velocities + 3 * v);
    double square = vec3_dot(velocity, velocity);
    if (!(square <= largest)) largest = isnan(square) ? INFINITY : square;
  }
  return sqrt(largest);
}

// Of its centre of mass, over the step to this state: net force by mass.
static double acceleration_of(const FemRest *rest, const FemModelBody *body, const FemState *state) {
  Vec3 sum = {0, 0, 0};
  double mass = 0;
  for (size_t v = (size_t)body->vertex_begin; v < (size_t)body->vertex_end; v++) {
    Vec3 change = vec3_sub(vec3_at(state->velocities + 3 * v), vec3_at(rest->before + 3 * v));
    sum = vec3_add(sum, vec3_scale(rest->model->mass[v], change));
    mass += rest->model->mass[v];
  }
  return vec3_length(sum) / (mass * (state->time - rest->before_time));
}

// Whether something began to act, or changed, since the last decision, or is changing now.
static bool is_disturbed(const FemRest *rest, int body, double time) {
  return next_change(rest, body, rest->decided_at) <= time || next_change(rest, body, time) <= time;
}

static void judge_bodies(FemRest *rest, const FemState *state) {
  double speed = fem_model_rest_speed(rest->model), acceleration = fem_model_rest_acceleration(rest->model);
  bool has_step = state->time > rest->before_time;
  for (int b = 0; b < rest->body_count; b++) {
    if (rest->is_held[b]) continue;
    const FemModelBody *body = &rest->model->bodies[b];
    bool stays = has_step ? fastest(body, state->velocities) <= speed : isfinite(rest->calm_since[b]);
    stays = stays && !is_disturbed(rest, b, state->time);
    rest->is_balanced[b] = has_step && acceleration_of(rest, body, state) <= acceleration;
    rest->calm_since[b] = stays ? fmin(rest->calm_since[b], state->time) : INFINITY;
  }
  memcpy(rest->before, state->velocities, 3 * (size_t)rest->model->vertex_count * sizeof(double));
  rest->before_time = state->time;
}

// ---- Islands.

static int root_of(const FemRest *rest, int party) {
  while (rest->root[party] != party) party = rest->root[party];
  return party;
}

// The lower number represents both.
static void join(FemRest *rest, int a, int b) {
  int p = root_of(rest, a), q = root_of(rest, b);
  rest->root[p > q ? p : q] = p > q ? q : p;
}

static unsigned char state_of(const FemRest *rest, int body, double time) {
  if (rest->is_held[body]) return is_disturbed(rest, body, time) ? IS_DISTURBED : 0;
  bool is_ready =
      rest->calm_since[body] + fem_model_rest_time(rest->model) <= time && rest->is_balanced[body];
  return is_ready ? IS_AWAKE : IS_AWAKE | IS_UNREADY;
}

// Decides which bodies to hold, by what is near them now.
static void decide(FemRest *rest, double time) {
  const ContactLayout *layout = contact_system_layout(rest->contact);
  const ContactInterfaceDef *interfaces = layout->interfaces;
  for (int p = 0; p < rest->party_count; p++) {
    bool is_obstacle = p >= rest->body_count;
    rest->root[p] = p;
    rest->state[p] = is_obstacle ? 0 : state_of(rest, p, time);
    rest->next_held[p] = is_obstacle && next_change(rest, p, time) > time;
  }
  for (int f = 0; f < layout->interface_count; f++) {
    int low = interfaces[f].a < interfaces[f].b ? interfaces[f].a : interfaces[f].b,
        high = interfaces[f].a + interfaces[f].b - low;
    if (!contact_system_is_near(rest->contact, f)) continue;
    if (high < rest->body_count)
      join(rest, low, high);
    else if (!rest->next_held[high])
      rest->state[low] |= IS_UNREADY | IS_DISTURBED;
  }
  for (int b = 0; b < rest->body_count; b++) rest->state[root_of(rest, b)] |= rest->state[b];
  for (int b = 0; b < rest->body_count; b++)
    rest->next_held[b] = !(rest->state[root_of(rest, b)] & (IS_UNREADY | IS_DISTURBED));
}

static bool differs(const FemRest *rest, int count) {
  return memcmp(rest->is_held, rest->next_held, (size_t)count * sizeof *rest->is_held) != 0;
}

static bool has_sleeper(const FemRest *rest, const bool *is_held) {
  bool has = false;
  for (int b = 0; b < rest->body_count; b++) has = has || is_held[b];
  return has;
}

// ---- Applying the decision.

static Status hold_contact(const FemRest *rest, const FemState *state, double step, const bool *is_held) {
  fem_system_forget(rest->system);
  return contact_system_hold(rest->contact, state->time, state->positions, state->velocities, step, is_held);
}

static void count_changes(FemRest *rest) {
  for (int b = 0; b < rest->body_count; b++) {
    rest->sleeps += rest->next_held[b] && !rest->is_held[b];
    rest->wakes += !rest->next_held[b] && rest->is_held[b];
    if (rest->next_held[b] != rest->is_held[b]) rest->calm_since[b] = INFINITY;
  }
}

static void find_next_change(FemRest *rest, double time) {
  rest->next_change = INFINITY;
  if (!has_sleeper(rest, rest->is_held)) return;
  for (int p = 0; p < rest->party_count; p++)
    if (rest->is_held[p]) rest->next_change = fmin(rest->next_change, next_change(rest, p, time));
}

static void adopt(FemRest *rest, double time) {
  rest->has_changed = rest->has_changed || differs(rest, rest->body_count);
  count_changes(rest);
  memcpy(rest->is_held, rest->next_held, (size_t)rest->party_count * sizeof *rest->is_held);
  find_next_change(rest, time);
}

// The lists of contact may be old: everything is searched at the present positions before anything is
// changed.
static Status change(FemRest *rest, const FemState *state, double step) {
  bool concerns_contact = has_sleeper(rest, rest->is_held) || has_sleeper(rest, rest->next_held);
  if (concerns_contact) {
    TRY(hold_contact(rest, state, step, NULL));
    decide(rest, state->time);
  }
  adopt(rest, state->time);
  return has_sleeper(rest, rest->is_held) ? hold_contact(rest, state, step, rest->is_held) : STATUS_OK;
}

static void count_time(FemRest *rest, double time) {
  if (time > rest->decided_at)
    for (int b = 0; b < rest->body_count; b++)
      if (rest->is_held[b]) rest->asleep_s += time - rest->decided_at;
}

// Restores the state from a checkpoint.
static Status restore(FemRest *rest, const FemState *state, double step) {
  rest->is_restored = false;
  for (int p = rest->body_count; p < rest->party_count; p++)
    rest->is_held[p] = next_change(rest, p, state->time) > state->time;
  find_next_change(rest, state->time);
  return has_sleeper(rest, rest->is_held) ? hold_contact(rest, state, step, rest->is_held) : STATUS_OK;
}

Status fem_rest_decide(FemRest *rest, double step) {
  if (!rest) return STATUS_OK;
  const FemState *state = &rest->system->accepted;
  if (rest->is_restored) TRY(restore(rest, state, step));
  if (isnan(rest->decided_at)) rest->decided_at = state->time;
  count_time(rest, state->time);
  judge_bodies(rest, state);
  decide(rest, state->time);
  Status status = differs(rest, rest->party_count) ? change(rest, state, step) : STATUS_OK;
  rest->decided_at = state->time;
  return status;
}

void fem_rest_report(const FemRest *rest, Record *counters) {
  if (!rest) return;
  const ContactCounters *contact = contact_system_counters(rest->contact);
  record_add(counters, "bodies_put_to_rest", rest->sleeps);
  record_add(counters, "bodies_awakened", rest->wakes);
  record_add(counters, "pairs_left_at_rest", contact->left_at_rest);
  record_number(counters, "body_seconds_at_rest", rest->asleep_s);
  record_number(counters, "energy_put_to_rest_J", rest->lost);
}

// asleep_s, lost; then of each body whether it sleeps, and since when it is calm (INFINITY: it is not).
Status fem_rest_save(const FemRest *rest, double **values, size_t *count) {
  size_t bodies = rest ? (size_t)rest->body_count : 0;
  *count = rest ? 2 + 2 * bodies : 0;
  *values = memory_zeroed(*count, sizeof **values);
  if (!*values) return status_no_memory("a checkpoint");
  if (!rest) return STATUS_OK;
  (*values)[0] = rest->asleep_s, (*values)[1] = rest->lost;
  for (size_t b = 0; b < bodies; b++) {
    (*values)[2 + b] = rest->is_held[b];
    (*values)[2 + bodies + b] = rest->calm_since[b];
  }
  return STATUS_OK;
}

Status fem_rest_load(FemRest *rest, const double *values, size_t count) {
  size_t bodies = rest ? (size_t)rest->body_count : 0, wanted = rest ? 2 + 2 * bodies : 0;
  if (count != wanted)
    return status_fail(STATUS_INPUT, "the checkpoint has %zu numbers of bodies at rest, this scene has %zu",
                       count, wanted);
  if (!rest) return STATUS_OK;
  rest->asleep_s = values[0], rest->lost = values[1];
  for (size_t b = 0; b < bodies; b++) {
    rest->is_held[b] = values[2 + b] != 0;
    rest->calm_since[b] = values[2 + bodies + b];
  }
  rest->before_time = rest->decided_at = NAN;
  rest->is_restored = rest->has_changed = true;
  return STATUS_OK;
}

bool fem_rest_has_changed(FemRest *rest) {
  if (!rest) return false;
  bool has_changed = rest->has_changed;
  rest->has_changed = false;
  return has_changed;
}

bool fem_rest_is_asleep(const FemRest *rest, int body) {
  return rest && body < rest->body_count && rest->is_held[body];
}

double fem_rest_next_change(const FemRest *rest) {
  return rest ? rest->next_change : INFINITY;
}

void fem_rest_add_loss(FemRest *rest, double energy) {
  rest->lost += energy;
}
