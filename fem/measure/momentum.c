// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/momentum.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/shape/shape.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/floating.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"

Status fem_momentum_create(FemMomentum *momentum, FemSystem *system) {
  size_t bodies = (size_t)system->model->scene->body_count;
  *momentum = (FemMomentum){.system = system, .body_count = (int)bodies};
  momentum->now = memory_zeroed(bodies, sizeof *momentum->now);
  momentum->next = memory_zeroed(bodies, sizeof *momentum->next);
  momentum->motions = memory_zeroed(bodies, sizeof *momentum->motions);
  momentum->groups = memory_zeroed(bodies, sizeof *momentum->groups);
  momentum->next_groups = memory_zeroed(bodies, sizeof *momentum->next_groups);
  bool has_loads = system->model->load_count > 0;
  if (has_loads) momentum->loads = memory_zeroed(3 * (size_t)system->model->vertex_count, sizeof(double));
  bool is_there = momentum->now && momentum->next && momentum->motions && momentum->groups &&
                  momentum->next_groups && (!has_loads || momentum->loads);
  if (!is_there) return status_no_memory("the balance of momentum");
  for (int b = 0; b < momentum->body_count; b++) momentum->groups[b] = b;
  return STATUS_OK;
}

void fem_momentum_destroy(FemMomentum *momentum) {
  memory_free(momentum->now);
  memory_free(momentum->next);
  memory_free(momentum->motions);
  memory_free(momentum->groups);
  memory_free(momentum->next_groups);
  memory_free(momentum->loads);
  *momentum = (FemMomentum){0};
}

static void add(FemMomentumBody *body, Vec3 force) {
  vec3_accumulate(body->force, force);
  body->sum += vec3_length(force);
}

static void add_motion(const FemSystem *system, const FemState *state, const FemModelBody *range,
                       FemMomentumBody *body) {
  for (int dof = 3 * range->vertex_begin; dof < 3 * range->vertex_end; dof++)
    if (system->numbering.unknown_of_dof[dof] >= 0)
      body->p[dof % 3] += system->model->mass[dof / 3] * state->velocities[dof];
}

static void add_gravity(const FemModel *model, const FemModelBody *range, FemMomentumBody *body) {
  if (model->scene->has_gravity) add(body, vec3_scale(range->mass, vec3_at(model->scene->gravity)));
}

// The speed of an obstacle where it presses [m/s], which the body may reach.
static double speed_of_obstacle(const FemMomentum *momentum, const FemState *state,
                                const ContactInterface *interface) {
  FemSystem *system = momentum->system;
  const FemModel *model = system->model;
  int number = interface->b - model->body_count;
  if (number >= 0) {
    void *contact = fem_system_effect(system, &fem_effect_contact);
    const ContactLayout *layout = contact_system_layout(fem_effect_contact_system(contact));
    const ContactShape *shape = &layout->def.shapes[number];
    bool has_centre = isfinite(interface->centre[0]);
    Vec3 centre = has_centre ? vec3_at(interface->centre) : contact_shape_point(shape, state->time);
    return vec3_length(contact_shape_velocity(shape, state->time, centre));
  }
  const FemModelBody *body = &model->bodies[interface->b];
  Vec3 sum = {0, 0, 0};
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    sum = vec3_add(sum, vec3_at(state->velocities + 3 * (size_t)a));
  return vec3_length(sum) / (body->vertex_end - body->vertex_begin);
}

static int group_of(const int *groups, int body) {
  while (groups[body] != body) body = groups[body];
  return body;
}

static void join(int *groups, int a, int b) {
  int first = group_of(groups, a), second = group_of(groups, b);
  groups[first > second ? first : second] = first < second ? first : second;
}

// What is held or driven as a whole does not.
static bool passes_on(const FemMomentum *momentum, const ContactInterface *interface) {
  const FemModel *model = momentum->system->model;
  return !fem_model_is_rigid(model, interface->a) && !fem_model_is_rigid(model, interface->b);
}

static void add_contact(const FemMomentum *momentum, const FemState *state, const ContactInterface *interface,
                        Vec3 force, FemMomentumBody *bodies, int *groups) {
  FemMomentumBody *a = &bodies[interface->a];
  if (interface->a == interface->b || interface->a >= momentum->body_count) return;
  add(a, force);
  if (interface->b < momentum->body_count) {
    add(&bodies[interface->b], vec3_scale(-1, force));
    if (vec3_length(force) > 0 && passes_on(momentum, interface)) join(groups, interface->a, interface->b);
  } else if (vec3_length(force) > 0)
    a->driven = fmax(a->driven, speed_of_obstacle(momentum, state, interface));
}

static Status add_loads(FemMomentum *momentum, const FemState *state, FemMomentumBody *bodies) {
  const FemModel *model = momentum->system->model;
  if (!momentum->loads) return STATUS_OK;
  memset(momentum->loads, 0, 3 * (size_t)model->vertex_count * sizeof(double));
  TRY(fem_effect_loads.add_force(fem_system_effect(momentum->system, &fem_effect_loads), state,
                                 momentum->loads));
  for (int b = 0; b < momentum->body_count; b++) {
    Vec3 sum = {0, 0, 0};
    for (int a = model->bodies[b].vertex_begin; a < model->bodies[b].vertex_end; a++)
      sum = vec3_add(sum, vec3_at(momentum->loads + 3 * a));
    add(&bodies[b], sum);
  }
  return STATUS_OK;
}

static int body_of(const FemModel *model, const FemModelDriver *driver) {
  for (int b = 0; b < model->scene->body_count && driver->dof_count > 0; b++)
    if (driver->dofs[0] / 3 >= model->bodies[b].vertex_begin &&
        driver->dofs[0] / 3 < model->bodies[b].vertex_end)
      return b;
  return -1;
}

// Reactions of fixed and driven coordinates: minus all other forces on them.
static Status add_reactions(const FemMomentum *momentum, const FemState *state, FemMomentumBody *bodies) {
  FemSystem *system = momentum->system;
  const FemModel *model = system->model;
  bool is_evaluated = false;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    int b = fem_model_is_released(driver, system->numbering.released) ? -1 : body_of(model, driver);
    if (b < 0 || system->numbering.is_held[b]) continue;
    if (!is_evaluated) TRY(fem_system_forces(system, state));
    is_evaluated = true;
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < driver->dof_count; i++) sum[driver->dofs[i] % 3] -= system->forces[driver->dofs[i]];
    add(&bodies[b], vec3_at(sum));
  }
  return STATUS_OK;
}

// Momenta and forces; zero for bodies that sleep. Joins groups that press each other.
static Status measure(FemMomentum *momentum, const FemState *state, const FemMomentumContact *contact,
                      FemMomentumBody *bodies, int *groups) {
  const FemModel *model = momentum->system->model;
  for (int b = 0; b < momentum->body_count; b++) {
    for (int c = 0; c < 3; c++) bodies[b].p[c] = bodies[b].force[c] = 0;
    bodies[b].sum = bodies[b].driven = 0;
    add_motion(momentum->system, state, &model->bodies[b], &bodies[b]);
    add_gravity(model, &model->bodies[b], &bodies[b]);
  }
  for (int i = 0; i < contact->count; i++)
    add_contact(momentum, state, &contact->interfaces[i], vec3_at(contact->forces[i]), bodies, groups);
  for (int b = 0; b < momentum->body_count; b++) groups[b] = group_of(groups, b);
  TRY(add_loads(momentum, state, bodies));
  TRY(add_reactions(momentum, state, bodies));
  for (int b = 0; b < momentum->body_count; b++) {
    if (!momentum->system->numbering.is_held[b]) continue;
    for (int c = 0; c < 3; c++) bodies[b].p[c] = bodies[b].force[c] = 0;
    bodies[b].sum = 0;
  }
  return STATUS_OK;
}

// The next step begins where the last one ended.
static void begin_next(FemMomentum *momentum) {
  const size_t bodies = (size_t)momentum->body_count;
  memcpy(momentum->next, momentum->now, bodies * sizeof *momentum->now);
  memcpy(momentum->next_groups, momentum->groups, bodies * sizeof *momentum->groups);
}

Status fem_momentum_begin(FemMomentum *momentum, const FemState *state, const FemMomentumContact *contact) {
  TRY(measure(momentum, state, contact, momentum->now, momentum->groups));
  begin_next(momentum);
  momentum->time = momentum->next_time = state->time;
  return STATUS_OK;
}

Status fem_momentum_end(FemMomentum *momentum, const FemState *state, const FemMomentumContact *contact) {
  double half = 0.5 * (state->time - momentum->time);
  begin_next(momentum);
  TRY(measure(momentum, state, contact, momentum->next, momentum->next_groups));
  momentum->next_time = state->time;
  for (int b = 0; b < momentum->body_count; b++) {
    const FemMomentumBody *now = &momentum->now[b];
    FemMomentumBody *next = &momentum->next[b];
    next->size += half * (now->sum + next->sum);
    for (int c = 0; c < 3; c++) {
      next->change[c] += next->p[c] - now->p[c];
      next->impulse[c] += half * (now->force[c] + next->force[c]);
    }
  }
  return STATUS_OK;
}

void fem_momentum_accept(FemMomentum *momentum) {
  const size_t bodies = (size_t)momentum->body_count;
  memcpy(momentum->now, momentum->next, bodies * sizeof *momentum->now);
  memcpy(momentum->groups, momentum->next_groups, bodies * sizeof *momentum->groups);
  momentum->time = momentum->next_time;
}

// J − Δp.
static Vec3 missing_of(const FemMomentumBody *body) {
  return vec3_sub(vec3_at(body->impulse), vec3_at(body->change));
}

static double weight_of(const FemMomentum *momentum, int body) {
  const FemModel *model = momentum->system->model;
  return model->scene->has_gravity ? model->bodies[body].mass * vec3_length(vec3_at(model->scene->gravity))
                                   : 0;
}

// Of the last accepted state, relative to the common velocity of the body's group.
static Vec3 momentum_of(const FemMomentum *momentum, const FemMomentumMotion *motion, int body) {
  double mass = momentum->system->model->bodies[body].mass;
  return vec3_sub(vec3_at(momentum->now[body].p), vec3_scale(mass, vec3_at(motion->common)));
}

static void find_common(const FemMomentum *momentum, const int *groups) {
  const FemModel *model = momentum->system->model;
  for (int b = 0; b < momentum->body_count; b++) {
    FemMomentumMotion *motion = &momentum->motions[groups[b]];
    motion->body_count++;
    motion->mass += model->bodies[b].mass;
    vec3_accumulate(motion->common, vec3_at(momentum->now[b].p));
  }
  for (int g = 0; g < momentum->body_count; g++) {
    FemMomentumMotion *motion = &momentum->motions[g];
    if (groups[g] != g) continue;
    Vec3 mean = vec3_scale(1 / motion->mass, vec3_at(motion->common));
    vec3_store(motion->common, fem_model_common_part(model, momentum->system->numbering.released, mean));
  }
}

// Of the groups. A body that touches nothing takes up nothing of others, however fast they are.
static void find_motions(const FemMomentum *momentum, const int *groups) {
  for (int b = 0; b < momentum->body_count; b++) momentum->motions[b] = (FemMomentumMotion){0};
  find_common(momentum, groups);
  for (int b = 0; b < momentum->body_count; b++) {
    FemMomentumMotion *motion = &momentum->motions[groups[b]];
    double p = vec3_length(momentum_of(momentum, motion, b));
    motion->momentum += p;
    motion->speed = fmax(motion->speed, p / momentum->system->model->bodies[b].mass);
  }
}

// An estimate of S of a body at the end of the run, `left` [s] from now, the larger of two: S so far, the
// impulse of its weight until then, and the momentum that a braking force has still to stop; or the momentum
// that a pressing obstacle and other bodies of the group may transfer to it. What skids along an obstacle
// keeps most of its own.
static double expected_of(const FemMomentum *momentum, const FemMomentumBody *body, int number, double left,
                          const FemMomentumMotion *motion) {
  const FemModel *model = momentum->system->model;
  Vec3 p = momentum_of(momentum, motion, number), force = vec3_at(body->force);
  double mass = model->bodies[number].mass, size = vec3_length(force),
         braked = size > 0 ? fmax(-vec3_dot(p, force) / size, 0) : 0;
  double acting = body->size + weight_of(momentum, number) * fmax(left, 0) + braked,
         given = motion->body_count > 1 ? fmin(motion->momentum, mass * motion->speed) : 0,
         moving = fmax(given, mass * body->driven);
  return fmax(fmax(acting, moving), mass * fem_model_velocity_tolerance(model));
}

// J − Δp of a body, less what a method of order 1 recovers as the force falls. While a force rises by f in
// even steps h, the trapezoidal rule over it misses h f/2 of the motion.
static double lasting_of(const FemMomentum *momentum, const FemMomentumBody *body, int number, double step,
                         double expected) {
  const FemModel *model = momentum->system->model;
  Vec3 weight = {0, 0, 0}, missing = missing_of(body);
  if (model->scene->has_gravity)
    weight = vec3_scale(model->bodies[number].mass, vec3_at(model->scene->gravity));
  Vec3 passing = vec3_scale(-0.5 * step, vec3_sub(vec3_at(body->force), weight));
  double owed = vec3_length(passing), most = FEM_MOMENTUM_OWED * expected;
  if (owed > most) passing = vec3_scale(most / owed, passing);
  return fmin(vec3_length(missing), vec3_length(vec3_sub(missing, passing)));
}

bool fem_momentum_is_refused(const FemMomentum *momentum, double end) {
  find_motions(momentum, momentum->next_groups);
  const double step = momentum->next_time - momentum->time, left = end - momentum->next_time;
  for (int b = 0; b < momentum->body_count; b++) {
    const FemMomentumBody *now = &momentum->now[b], *next = &momentum->next[b];
    double expected = expected_of(momentum, next, b, left, &momentum->motions[momentum->next_groups[b]]);
    double before = lasting_of(momentum, now, b, step, expected),
           after = lasting_of(momentum, next, b, step, expected);
    double room = fmax(0.5 * (FEM_MOMENTUM_FAR * expected - before), FEM_MOMENTUM_STEP * expected);
    bool is_held = after <= FEM_MOMENTUM_NEAR * expected || after - before <= room;
    if (!is_held) return true;
  }
  return false;
}

double fem_momentum_strictness(const FemMomentum *momentum, double end) {
  find_motions(momentum, momentum->groups);
  double share = 0;
  for (int b = 0; b < momentum->body_count; b++) {
    const FemMomentumBody *now = &momentum->now[b];
    bool falls_freely = now->sum <= weight_of(momentum, b);
    if (falls_freely) continue;
    double expected =
        expected_of(momentum, now, b, end - momentum->time, &momentum->motions[momentum->groups[b]]);
    share = fmax(share, vec3_length(missing_of(now)) / expected);
  }
  double from = FEM_MOMENTUM_STRICT, to = FEM_MOMENTUM_FAR,
         beyond = fmin(fmax((share - from) / (to - from), 0), 1);
  return 1 - (1 - FEM_RESERVE) * beyond;
}

// How much of the last step lies before a time.
static double share_at(const FemMomentum *momentum, double time) {
  double step = momentum->next_time - momentum->time;
  return step > 0 ? fmin(fmax((time - momentum->time) / step, 0), 1) : 1;
}

void fem_momentum_missing(const FemMomentum *momentum, double time, int body, double missing[3]) {
  double share = share_at(momentum, time);
  Vec3 now = missing_of(&momentum->now[body]), next = missing_of(&momentum->next[body]);
  vec3_store(missing, vec3_add(vec3_scale(1 - share, now), vec3_scale(share, next)));
}

double fem_momentum_gap(const FemMomentum *momentum, double time, int body) {
  const FemModel *model = momentum->system->model;
  double missing[3], least = model->bodies[body].mass * fem_model_velocity_tolerance(model);
  double share = share_at(momentum, time),
         size = (1 - share) * momentum->now[body].size + share * momentum->next[body].size;
  fem_momentum_missing(momentum, time, body, missing);
  return vec3_length(vec3_at(missing)) / fmax(size, least);
}

double fem_momentum_largest_gap(const FemMomentum *momentum, double time, int *body) {
  double largest = 0;
  if (body) *body = 0;
  for (int b = 0; b < momentum->body_count; b++) {
    double gap = fem_momentum_gap(momentum, time, b);
    if (!(gap > largest) && !isnan(gap)) continue;
    largest = gap;
    if (body) *body = b;
  }
  return largest;
}

void fem_momentum_save(const FemMomentum *momentum, double *values) {
  for (int b = 0; b < momentum->body_count; b++, values += FEM_MOMENTUM_KEPT) {
    memcpy(values, momentum->now[b].change, 3 * sizeof *values);
    memcpy(values + 3, momentum->now[b].impulse, 3 * sizeof *values);
    values[6] = momentum->now[b].size;
    values[7] = momentum->groups[b];
  }
}

bool fem_momentum_fits(const FemMomentum *momentum, const double *values) {
  for (int b = 0; b < momentum->body_count; b++) {
    double group = values[b * FEM_MOMENTUM_KEPT + 7];
    bool is_body = group >= 0 && group <= b && group == floor(group);
    if (!is_body || values[(int)group * FEM_MOMENTUM_KEPT + 7] != group) return false;
  }
  return true;
}

void fem_momentum_load(FemMomentum *momentum, const double *values) {
  for (int b = 0; b < momentum->body_count; b++, values += FEM_MOMENTUM_KEPT) {
    memcpy(momentum->now[b].change, values, 3 * sizeof *values);
    memcpy(momentum->now[b].impulse, values + 3, 3 * sizeof *values);
    momentum->now[b].size = values[6];
    momentum->groups[b] = (int)values[7];
  }
  begin_next(momentum);
}
