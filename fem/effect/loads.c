// SPDX-License-Identifier: GPL-3.0-or-later
// Loads from outside: forces, body forces, tractions, pressures, torques, each a function of time. Their work
// goes into the energy audit: step by step, mean force times way, which is exact for a constant dead load; of
// a torque by Simpson's rule, since its forces turn within the step.
//
// A torque adds nothing to the matrix: its derivative couples all vertices of the selection with each other,
// and a moment of constant direction has no potential. Newton's method then takes more iterations, as many as
// the turn within a step asks for.
#include "fem/effect/loads.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/element/quadratic_face.h"

typedef struct Loads {
  const FemModel *model; // borrowed
  int place;             // of its history: the work until the last accepted state [J]
  double *force, *last;  // scratch: now, and at that state [N]        (vertex_count, 3)
  double *middle;        // scratch: positions within a step [m]; NULL: no torque (vertex_count, 3)
  double *acceleration;  // the largest at factor 1, at rest [m/s²]    (model->load_count)
} Loads;

static bool is_wanted(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++)
    if (scene->bodies[b].load_count > 0) return true;
  return false;
}

static void destroy(void *self) {
  Loads *loads = self;
  memory_free(loads->force);
  memory_free(loads->last);
  memory_free(loads->middle);
  memory_free(loads->acceleration);
  memory_free(loads);
}

static double find_acceleration(const Loads *loads, const FemLoad *load) {
  const FemModel *model = loads->model;
  double largest = 0;
  memset(loads->force, 0, 3 * (size_t)model->vertex_count * sizeof *loads->force);
  fem_load_add_force(load, 1, model->rest, loads->force);
  for (size_t v = 0; v < (size_t)model->vertex_count; v++)
    if (model->mass[v] > 0)
      largest = fmax(largest, vec3_length(vec3_at(loads->force + 3 * v)) / model->mass[v]);
  return largest;
}

static Status create(void **self, const FemModel *model) {
  Loads *loads = memory_zeroed(1, sizeof *loads);
  if (!loads) return status_no_memory("loads");
  size_t values = 3 * (size_t)model->vertex_count;
  loads->model = model;
  loads->force = memory_zeroed(values, sizeof(double));
  loads->last = memory_zeroed(values, sizeof(double));
  loads->acceleration = memory_zeroed((size_t)model->load_count, sizeof(double));
  bool turns = false;
  for (int i = 0; i < model->load_count; i++) turns = turns || model->loads[i].weight;
  if (turns) loads->middle = memory_zeroed(values, sizeof(double));
  if (!loads->force || !loads->last || !loads->acceleration || (turns && !loads->middle)) {
    destroy(loads);
    return status_no_memory("loads");
  }
  for (int i = 0; i < model->load_count; i++)
    loads->acceleration[i] = find_acceleration(loads, &model->loads[i]);
  *self = loads;
  return STATUS_OK;
}

static Status add_force(void *self, const FemState *state, double *force) {
  const FemModel *model = ((const Loads *)self)->model;
  for (int i = 0; i < model->load_count; i++) {
    double factor;
    TRY(fem_load_factor(model->loads[i].def, state->time, &factor));
    fem_load_add_force(&model->loads[i], factor, state->positions, force);
  }
  return STATUS_OK;
}

static Status connect(void *self, const FemSystem *system) {
  ((Loads *)self)->place = fem_system_place(system, &fem_effect_loads);
  return STATUS_OK;
}

static Status find_forces(Loads *loads, const FemState *state, double *force) {
  memset(force, 0, 3 * (size_t)loads->model->vertex_count * sizeof *force);
  return add_force(loads, state, force);
}

// What Simpson's rule adds to that of the trapezium for the work of a torque over the step to a state.
static Status add_turning(Loads *loads, const FemLoad *load, const FemState *state, double *work) {
  const FemState *last = state->last;
  double begin, middle, end;
  int values = 3 * loads->model->vertex_count;
  TRY(fem_load_factor(load->def, last->time, &begin));
  TRY(fem_load_factor(load->def, 0.5 * (last->time + state->time), &middle));
  TRY(fem_load_factor(load->def, state->time, &end));
  for (int i = 0; i < values; i++) loads->middle[i] = 0.5 * (last->positions[i] + state->positions[i]);
  memset(loads->force, 0, (size_t)values * sizeof *loads->force);
  fem_load_add_force(load, -begin / 3, last->positions, loads->force);
  fem_load_add_force(load, 2 * middle / 3, loads->middle, loads->force);
  fem_load_add_force(load, -end / 3, state->positions, loads->force);
  for (int i = 0; i < values; i++) *work += loads->force[i] * (state->positions[i] - last->positions[i]);
  return STATUS_OK;
}

// Until a state, over the step to it: mean force times way.
static Status find_work(Loads *loads, const FemState *state, double *work) {
  const FemState *last = state->last;
  *work = last->histories[loads->place].values[0];
  TRY(find_forces(loads, state, loads->force));
  TRY(find_forces(loads, last, loads->last));
  for (int i = 0; i < 3 * loads->model->vertex_count; i++)
    *work += 0.5 * (loads->last[i] + loads->force[i]) * (state->positions[i] - last->positions[i]);
  for (int i = 0; i < loads->model->load_count; i++)
    if (loads->model->loads[i].weight) TRY(add_turning(loads, &loads->model->loads[i], state, work));
  return STATUS_OK;
}

Status fem_effect_loads_change(const FemSystem *system, const FemState *state, double *change) {
  Loads *loads = fem_system_effect(system, &fem_effect_loads);
  const FemState *last = state->last;
  *change = 0;
  if (!loads) return STATUS_OK;
  TRY(find_forces(loads, state, loads->force));
  TRY(find_forces(loads, last, loads->last));
  for (int i = 0; i < 3 * loads->model->vertex_count; i++)
    *change += (loads->force[i] - loads->last[i]) * (state->positions[i] - last->positions[i]);
  return STATUS_OK;
}

static Status start(void *self, const FemState *state, FemEffectHistory *history) {
  (void)self, (void)state;
  return fem_effect_history_set(history, &(double){0}, 1);
}

static Status advance(void *self, const FemState *state, FemEffectHistory *next) {
  TRY(fem_effect_history_resize(next, 1));
  return find_work(self, state, next->values);
}

static Status check_history(const void *self, const double *values, size_t count) {
  (void)self, (void)values;
  if (count == 1) return STATUS_OK;
  return status_fail(STATUS_INPUT, "the checkpoint has %zu numbers of the loads' work, not one", count);
}

static double horizon(const void *self, const FemForesight *foresight, double time, double farthest) {
  const Loads *loads = self;
  for (int i = 0; i < loads->model->load_count; i++)
    farthest =
        fem_load_horizon(loads->model->loads[i].def, loads->acceleration[i], foresight, time, farthest);
  return farthest;
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  (void)state;
  const FemModel *model = ((const Loads *)self)->model;
  for (int i = 0; i < model->load_count; i++) {
    const FemLoad *load = &model->loads[i];
    for (int k = 0; k < load->triangle_count; k++)
      TRY(fem_pattern_add_clique(pattern, 3, load->triangles[k], has_grown));
    for (int k = 0; k < load->face_count; k++)
      TRY(fem_pattern_add_clique(pattern, FEM_QUADRATIC_FACE_NODES, load->faces[k], has_grown));
  }
  return STATUS_OK;
}

static void add_face(const int face[6], const FemState *state, double pressure, double stiffness_scale,
                     FemMatrix *matrix) {
  double x[18], stiffness[324];
  for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++)
    memcpy(x + 3 * k, state->positions + 3 * (size_t)face[k], 3 * sizeof *x);
  fem_quadratic_face_stiffness(pressure, x, stiffness);
  fem_matrix_add(matrix, FEM_QUADRATIC_FACE_NODES, face, stiffness, stiffness_scale);
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale;
  const FemModel *model = ((const Loads *)self)->model;
  for (int i = 0; i < model->load_count && stiffness_scale != 0; i++) {
    const FemLoad *load = &model->loads[i];
    if (load->triangle_count + load->face_count == 0) continue;
    double factor, stiffness[81];
    TRY(fem_load_factor(load->def, state->time, &factor));
    for (int k = 0; k < load->triangle_count; k++) {
      const int *t = load->triangles[k];
      fem_load_triangle_stiffness(factor * load->def->pressure, state->positions + 3 * (size_t)t[0],
                                  state->positions + 3 * (size_t)t[1], state->positions + 3 * (size_t)t[2],
                                  stiffness);
      fem_matrix_add(matrix, 3, t, stiffness, stiffness_scale);
    }
    for (int k = 0; k < load->face_count; k++)
      add_face(load->faces[k], state, factor * load->def->pressure, stiffness_scale, matrix);
  }
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  double work;
  TRY(find_work(self, state, &work));
  energy->applied_work += work;
  return STATUS_OK;
}

static void report(void *self, const FemState *state, Record *counters) {
  record_number(counters, "load_work_J", state->histories[((Loads *)self)->place].values[0]);
}

static bool is_linear(void *self) {
  const FemModel *model = ((const Loads *)self)->model;
  for (int i = 0; i < model->load_count; i++)
    if (fem_load_follows(&model->loads[i])) return false;
  return true;
}

static size_t bytes(const void *self) {
  const Loads *loads = self;
  return memory_held(self) + memory_held(loads->force) + memory_held(loads->last) +
         memory_held(loads->middle) + memory_held(loads->acceleration);
}

const FemEffectOps fem_effect_loads = {
    .name = "loads",
    .help = "forces, body forces, tractions, pressures and torques from outside, by functions of time",
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
    .horizon = horizon,
    .report = report,
    .is_linear = is_linear,
    .bytes = bytes,
    .destroy = destroy,
};
