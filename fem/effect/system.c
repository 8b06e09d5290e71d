// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/system.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/effect/formulas.h"
#include "fem/model/drivers.h"
#include "fem/scene/drive.h"
#include "fem/sparse/solver.h"
#include "fem/sparse/vector.h"

// A message about the scene begins with its place there.
static Status name_effect(Status status, const FemEffectOps *ops) {
  return status == STATUS_OK || status == STATUS_INPUT ? status
                                                       : status_prefix(status, "effect '%s'", ops->name);
}

// After a failure there is none.
static Status create_effect_again(FemEffect *effect, const FemModel *model) {
  const FemEffectOps *ops = effect->ops;
  void *old = effect->self;
  effect->self = NULL;
  Status status =
      ops->create_again ? ops->create_again(&effect->self, &old) : ops->create(&effect->self, model);
  if (old) ops->destroy(old);
  return name_effect(status, ops);
}

static Status connect_effects(FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffectOps *ops = system->effects[i].ops;
    TRY(name_effect(ops->connect ? ops->connect(system->effects[i].self, system) : STATUS_OK, ops));
  }
  return STATUS_OK;
}

static Status create_effects(FemSystem *system) {
  int count;
  const FemEffectOps *const *list = fem_effect_list(&count);
  for (int i = 0; i < count; i++) {
    if (!list[i]->is_wanted(system->model->scene)) continue;
    FemEffect *effect = &system->effects[system->effect_count];
    effect->ops = list[i];
    TRY(name_effect(effect->ops->create(&effect->self, system->model), effect->ops));
    system->effect_count++;
  }
  return connect_effects(system);
}

static void weigh_effects(FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    long long bytes = effect->ops->bytes ? (long long)effect->ops->bytes(effect->self) : 0;
    if (bytes > system->costs[i].bytes_max) system->costs[i].bytes_max = bytes;
  }
}

// Every unknown couples at least with those of its own vertex.
static Status couple_vertices(FemSystem *system) {
  for (int a = 0; a < system->model->vertex_count; a++)
    TRY(fem_pattern_add_clique(system->pattern, 1, &a, NULL));
  return STATUS_OK;
}

// Lets effects tell their couplings: those that may change, or the others.
static Status couple_effects(FemSystem *system, const FemState *state, bool changing, int *has_grown) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffectOps *ops = system->effects[i].ops;
    if (!ops->couple || ops->couples_anew != changing) continue;
    // What changes is laid out on every rank, since parts of its cliques may belong to others.
    fem_pattern_set_share(system->pattern, ops->couples_anew ? NULL : system->model->share);
    TRY(ops->couple(system->effects[i].self, state, system->pattern, has_grown));
  }
  return STATUS_OK;
}

static Status lay_out(FemSystem *system) {
  double began = clock_wall_s();
  fem_matrix_destroy(&system->matrix);
  TRY(fem_matrix_create(&system->matrix, system->pattern, system->numbering.unknown_of_dof));
  system->matrix.rest = system->model->rest;
  system->matrix.share = system->model->share;
  system->pattern_version++;
  system->layout_s += clock_wall_s() - began;
  return STATUS_OK;
}

// The lists of effects, for evaluations near a state.
static Status renew_lists(FemSystem *system, const FemState *state, double step) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    if (!effect->ops->renew) continue;
    double began = clock_wall_s();
    TRY(effect->ops->renew(effect->self, state, step));
    system->costs[i].prepare_s += clock_wall_s() - began;
    system->costs[i].prepare_calls++;
  }
  return STATUS_OK;
}

// What effects remember where a run begins.
static Status start_histories(FemSystem *system) {
  FemState *state = &system->accepted;
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    state->histories[i].count = 0;
    if (effect->ops->start) TRY(effect->ops->start(effect->self, state, &state->histories[i]));
  }
  return STATUS_OK;
}

// The state is accepted, but for what effects remember.
static void take_state(FemSystem *system, const FemState *state) {
  size_t bytes = 3 * (size_t)system->model->vertex_count * sizeof(double);
  memcpy(system->accepted.positions, state->positions, bytes);
  memcpy(system->accepted.velocities, state->velocities, bytes);
  system->accepted.time = state->time;
  system->accepted.version = state->version;
}

static Status create_accepted(FemSystem *system) {
  const FemModel *model = system->model;
  TRY(fem_state_create(&system->accepted, model->vertex_count, model->rest, model->initial_velocity));
  system->accepted.is_held = system->numbering.is_held;
  fem_model_drivers_move(model, 0, 0, system->accepted.positions, system->accepted.velocities);
  return STATUS_OK;
}

// What never changes of the matrix pattern, up to its mark.
static Status create_pattern(FemSystem *system) {
  TRY(fem_pattern_create(&system->pattern, system->model->vertex_count));
  TRY(couple_vertices(system));
  TRY(couple_effects(system, &system->accepted, false, NULL));
  fem_pattern_mark(system->pattern);
  return STATUS_OK;
}

// Lists, histories, couplings and matrix of the accepted state, whatever there was before. A layout that
// comes out the same stays, but where ranks have to agree on it.
static Status begin_at_accepted(FemSystem *system, double step) {
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops->forget) system->effects[i].ops->forget(system->effects[i].self);
  TRY(renew_lists(system, &system->accepted, step));
  TRY(start_histories(system));
  fem_pattern_take_back(system->pattern);
  TRY(couple_effects(system, &system->accepted, true, NULL));
  if (system->numbering.count == 0) return STATUS_OK;
  bool fits = fem_matrix_fits(&system->matrix, system->pattern, system->numbering.unknown_of_dof);
  if (!fits || system->model->share) return lay_out(system);
  system->pattern_version++; // as if it had been laid out
  return STATUS_OK;
}

static Status create(FemSystem *system) {
  size_t values = 3 * (size_t)system->model->vertex_count;
  TRY(fem_numbering_create(&system->numbering, system->model));
  if (system->numbering.count == 0)
    return status_fail(STATUS_INPUT,
                       "every vertex is fixed or driven: there is nothing to solve; free some vertices");
  TRY(create_accepted(system));
  system->forces = memory_zeroed(values + 1, sizeof *system->forces);
  if (!system->forces) return status_no_memory("the state");
  TRY(create_effects(system));
  TRY(create_pattern(system));
  TRY(begin_at_accepted(system, 0));
  weigh_effects(system);
  return STATUS_OK;
}

Status fem_system_create(FemSystem *system, const FemModel *model) {
  *system = (FemSystem){.model = model};
  TRY(create(system));
  system->is_whole = true;
  return STATUS_OK;
}

static Status create_again(FemSystem *system) {
  FemNumbering *numbering = &system->numbering;
  numbering->released = 0;
  memset(numbering->is_held, 0, (size_t)system->model->body_count * sizeof *numbering->is_held);
  fem_numbering_renew(numbering, system->model);
  memset(system->costs, 0, sizeof system->costs);
  system->layout_s = 0;
  system->pattern_version = 0;
  system->stop = NULL;
  fem_state_destroy(&system->accepted);
  TRY(create_accepted(system));
  for (int i = 0; i < system->effect_count; i++) TRY(create_effect_again(&system->effects[i], system->model));
  TRY(connect_effects(system));
  return start_histories(system);
}

Status fem_system_create_again(FemSystem *system) {
  system->is_whole = false;
  TRY(create_again(system));
  system->is_whole = true;
  return STATUS_OK;
}

void fem_system_destroy(FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].self) system->effects[i].ops->destroy(system->effects[i].self);
  fem_matrix_destroy(&system->matrix);
  fem_pattern_destroy(system->pattern);
  fem_numbering_destroy(&system->numbering);
  fem_state_destroy(&system->accepted);
  for (int i = 0; i < FEM_MAX_EFFECTS; i++) fem_effect_history_destroy(&system->next[i]);
  memory_free(system->forces);
  *system = (FemSystem){0};
}

Status fem_system_create_state(const FemSystem *system, FemState *state) {
  const FemState *accepted = &system->accepted;
  TRY(fem_state_create(state, system->model->vertex_count, accepted->positions, accepted->velocities));
  state->time = accepted->time;
  state->version = accepted->version;
  state->last = accepted;
  state->is_held = accepted->is_held;
  return STATUS_OK;
}

void fem_system_scatter(const FemSystem *system, double time, const double *u, const double *v,
                        FemState *state) {
  const FemModel *model = system->model;
  const FemNumbering *numbering = &system->numbering;
  bool is_another = time != state->time;
#pragma omp parallel for schedule(static) reduction(|| : is_another) if (numbering->count > FEM_VECTOR_LONG)
  for (int i = 0; i < numbering->count; i++) {
    int dof = numbering->dof_of_unknown[i];
    double position = model->rest[dof] + u[i];
    is_another = is_another || state->positions[dof] != position;
    state->positions[dof] = position;
    if (v) state->velocities[dof] = v[i];
  }
  if (is_another) state->version = fem_state_new_version();
  state->time = time;
  fem_model_drivers_move(model, numbering->released, time, state->positions, state->velocities);
  if (!v) memset(state->velocities, 0, 3 * (size_t)model->vertex_count * sizeof *state->velocities);
}

void fem_system_gather(const FemSystem *system, const FemState *state, double *u, double *v) {
  for (int i = 0; i < system->numbering.count; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    u[i] = state->positions[dof] - system->model->rest[dof];
    v[i] = state->velocities[dof];
  }
}

// `what`: of which array the first value that is no number is named. RETRY if there is one.
static Status check_numbers(const FemSystem *system, const double *values, const char *what,
                            const char *from) {
  int count = 3 * system->model->vertex_count, i = 0;
  if (fem_vector_is_finite(count, values)) return STATUS_OK;
  while (isfinite(values[i])) i++;
  return status_fail(STATUS_RETRY, "the %s vertex %d of body '%s' is not a number%s%s%s", what, i / 3,
                     fem_model_body_name(system->model, i / 3), from ? " (effect '" : "", from ? from : "",
                     from ? "')" : "");
}

Status fem_system_check_state(const FemSystem *system, const FemState *state) {
  TRY(check_numbers(system, state->positions, "position of", NULL));
  return check_numbers(system, state->velocities, "velocity of", NULL);
}

static Status check_stop(const FemSystem *system) {
  return system->stop && *system->stop ? status_fail(STATUS_INTERRUPTED, "interrupted") : STATUS_OK;
}

static Status add_forces(FemSystem *system, const FemState *state, FemEffectPart part) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    if (!effect->ops->add_force || !fem_effect_is_of(effect, part)) continue;
    double began = clock_wall_s();
    TRY(effect->ops->add_force(effect->self, state, system->forces));
    system->costs[i].force_s += clock_wall_s() - began;
    system->costs[i].force_calls++;
  }
  return STATUS_OK;
}

// Σ over ranks of what each has added, unless one could not.
static Status sum_forces(FemSystem *system, Status status) {
  size_t values = 3 * (size_t)system->model->vertex_count;
  system->forces[values] = status != STATUS_OK;
  ranks()->sum(system->forces, values + 1);
  return system->forces[values] > 0 ? ranks()->worst(status) : STATUS_OK;
}

// Asks the effects one after the other for the force that is no number.
static Status blame_effect(FemSystem *system, const FemState *state) {
  memset(system->forces, 0, 3 * (size_t)system->model->vertex_count * sizeof *system->forces);
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    if (!effect->ops->add_force) continue;
    Status status = effect->ops->add_force(effect->self, state, system->forces);
    if (!status) status = check_numbers(system, system->forces, "force on", effect->ops->name);
    TRY(ranks()->worst(status));
  }
  return status_fail(STATUS_RETRY, "a force was not a number once, but is one now");
}

// What each rank gives by itself.
static Status add_own_forces(FemSystem *system, const FemState *state, FemEffectPart part) {
  TRY(check_stop(system));
  memset(system->forces, 0, 3 * (size_t)system->model->vertex_count * sizeof *system->forces);
  TRY(fem_formulas_check(system->model, state->time));
  TRY(fem_system_check_state(system, state));
  return add_forces(system, state, part);
}

Status fem_system_forces(FemSystem *system, const FemState *state) {
  if (system->model->share) {
    TRY(sum_forces(system, add_own_forces(system, state, FEM_EFFECT_DIVIDED)));
    TRY(ranks()->worst(add_forces(system, state, FEM_EFFECT_WHOLE)));
  } else {
    TRY(add_own_forces(system, state, FEM_EFFECT_ALL));
  }
  bool is_finite = fem_vector_is_finite(3 * system->model->vertex_count, system->forces);
  return is_finite ? STATUS_OK : blame_effect(system, state);
}

Status fem_system_forces_of_all(FemSystem *system, const FemState *state) {
  FemState all = *state;
  all.is_held = NULL;
  return fem_system_forces(system, &all);
}

Status fem_system_couple(FemSystem *system, const FemState *state) {
  int has_grown = 0;
  TRY(couple_effects(system, state, true, &has_grown));
  if (!ranks_any(has_grown)) return STATUS_OK;
  return ranks()->worst(lay_out(system));
}

bool fem_system_is_linear(const FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffectOps *ops = system->effects[i].ops;
    if (!ops->is_linear || !ops->is_linear(system->effects[i].self)) return false;
  }
  return true;
}

Status fem_system_renumber(FemSystem *system) {
  return system->numbering.count > 0 ? lay_out(system) : STATUS_OK;
}

static Status assemble(FemSystem *system, const FemState *state, double k, double d, double m,
                       const FemEffectOps *left_out, FemMatrix *matrix) {
  TRY(check_stop(system));
  fem_matrix_zero(matrix);
  for (int i = 0; i < system->effect_count; i++) {
    if (!system->effects[i].ops->add_jacobian || system->effects[i].ops == left_out) continue;
    double began = clock_wall_s();
    TRY(system->effects[i].ops->add_jacobian(system->effects[i].self, state, k, d, matrix));
    system->costs[i].jacobian_s += clock_wall_s() - began;
    system->costs[i].jacobian_calls++;
  }
  if (m != 0) fem_matrix_add_mass(matrix, system->model->mass, m);
  return STATUS_OK;
}

Status fem_system_assemble(FemSystem *system, const FemState *state, double k, double d, double m,
                           FemMatrix *matrix) {
  return fem_system_assemble_without(system, NULL, state, k, d, m, matrix);
}

Status fem_system_assemble_without(FemSystem *system, const FemEffectOps *left_out, const FemState *state,
                                   double k, double d, double m, FemMatrix *matrix) {
  return ranks()->worst(assemble(system, state, k, d, m, left_out, matrix));
}

static Status begin(FemSystem *system, const FemState *state, double next_step) {
  TRY(fem_formulas_check(system->model, state->time));
  take_state(system, state);
  return begin_at_accepted(system, next_step);
}

Status fem_system_begin(FemSystem *system, const FemState *state, double next_step) {
  return ranks()->worst(begin(system, state, next_step));
}

Status fem_system_remember(FemSystem *system, int place, const double *values, size_t count) {
  const FemEffect *effect = &system->effects[place];
  if (effect->ops->check_history) TRY(effect->ops->check_history(effect->self, values, count));
  fem_system_forget(system);
  return fem_effect_history_set(&system->accepted.histories[place], values, count);
}

void fem_system_forget(FemSystem *system) {
  system->accepted.version = fem_state_new_version();
}

Status fem_system_renew(FemSystem *system, const FemState *state) {
  return ranks()->worst(renew_lists(system, state, 0));
}

// What effects remember at the state, once it is accepted.
static Status advance(FemSystem *system, const FemState *state) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    if (!effect->ops->advance) continue;
    double began = clock_wall_s();
    TRY(effect->ops->advance(effect->self, state, &system->next[i]));
    system->costs[i].prepare_s += clock_wall_s() - began;
    system->costs[i].prepare_calls++;
  }
  return STATUS_OK;
}

static Status accept(FemSystem *system, const FemState *state, double next_step) {
  TRY(fem_formulas_check(system->model, state->time));
  TRY(check_stop(system));
  TRY(renew_lists(system, state, next_step));
  TRY(advance(system, state));
  for (int i = 0; i < system->effect_count; i++) {
    FemEffectHistory before = system->accepted.histories[i];
    system->accepted.histories[i] = system->next[i];
    system->next[i] = before;
  }
  take_state(system, state);
  weigh_effects(system);
  return STATUS_OK;
}

// Ranks decide alike because their states are the same: a checksum of positions and velocities, as two
// numbers and their negatives, whose largest over ranks must be those.
static Status compare_states(const FemSystem *system, const FemState *state) {
  uint64_t sum = 1469598103934665603u, bits;
  for (size_t i = 0; i < 6 * (size_t)system->model->vertex_count; i++) {
    const double *value = i % 2 ? state->velocities + i / 2 : state->positions + i / 2;
    memcpy(&bits, value, sizeof bits);
    sum = (sum ^ bits) * 1099511628211u;
    sum ^= sum >> 29;
  }
  double low = (double)(sum & 0xffffffff), high = (double)(sum >> 32), most[4] = {low, -low, high, -high};
  ranks()->most(most, 4);
  if (most[0] == -most[1] && most[2] == -most[3]) return STATUS_OK;
  return status_fail(STATUS_SOLVER,
                     "the ranks' states are not the same to the last bit: are their processors of different "
                     "kinds? Take machines of one kind");
}

Status fem_system_accept(FemSystem *system, const FemState *state, double next_step) {
  if (system->model->share) TRY(compare_states(system, state));
  return ranks()->worst(accept(system, state, next_step));
}

double fem_system_horizon(const FemSystem *system, const FemForesight *foresight, double time,
                          double farthest) {
  const FemModel *model = system->model;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    if (fem_model_is_moved(driver, system->numbering.released))
      farthest = fem_drive_horizon(driver->def, model->length, foresight, time, farthest);
  }
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops->horizon)
      farthest = system->effects[i].ops->horizon(system->effects[i].self, foresight, time, farthest);
  return farthest;
}

double fem_system_longest_step(const FemSystem *system) {
  double longest = INFINITY;
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops->longest_step)
      longest = fmin(longest, system->effects[i].ops->longest_step(system->effects[i].self));
  return longest;
}

bool fem_system_dissipates(const FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops->dissipates) return true;
  return false;
}

int fem_system_place(const FemSystem *system, const FemEffectOps *effect) {
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops == effect) return i;
  return -1;
}

void *fem_system_effect(const FemSystem *system, const FemEffectOps *effect) {
  int place = fem_system_place(system, effect);
  return place < 0 ? NULL : system->effects[place].self;
}
