// SPDX-License-Identifier: GPL-3.0-or-later
// Loads from outside: forces, body forces, tractions, pressures, each a function of time. Their work goes
// into the energy audit: step by step, mean force times way, which is exact for a constant dead load.
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/effect.h"
#include "fem/element/quadratic_face.h"

typedef struct Loads {
  const FemModel *model; // borrowed
  double *kept_force;    // at the last accepted state [N]     (vertex_count, 3)
  double *kept_position; // [m]                                (vertex_count, 3)
  double *force;         // scratch                            (vertex_count, 3)
  double *acceleration;  // the largest at factor 1, at rest [m/s²]    (model->load_count)
  double kept_work;      // until then [J]
  bool is_started;
} Loads;

static bool is_wanted(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++)
    if (scene->bodies[b].load_count > 0) return true;
  return false;
}

static void destroy(void *self) {
  Loads *loads = self;
  memory_free(loads->kept_force);
  memory_free(loads->kept_position);
  memory_free(loads->force);
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
  loads->kept_force = memory_zeroed(values, sizeof(double));
  loads->kept_position = memory_zeroed(values, sizeof(double));
  loads->force = memory_zeroed(values, sizeof(double));
  loads->acceleration = memory_zeroed((size_t)model->load_count, sizeof(double));
  if (!loads->kept_force || !loads->kept_position || !loads->force || !loads->acceleration) {
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

static Status find_forces(Loads *loads, const FemState *state) {
  memset(loads->force, 0, 3 * (size_t)loads->model->vertex_count * sizeof *loads->force);
  return add_force(loads, state, loads->force);
}

// Work until `state`, whose forces are in `force`.
static double work_until(const Loads *loads, const FemState *state) {
  double work = loads->kept_work;
  for (int i = 0; loads->is_started && i < 3 * loads->model->vertex_count; i++)
    work += 0.5 * (loads->kept_force[i] + loads->force[i]) * (state->positions[i] - loads->kept_position[i]);
  return work;
}

static Status prepare(void *self, const FemState *state, double step) {
  (void)step;
  Loads *loads = self;
  size_t bytes = 3 * (size_t)loads->model->vertex_count * sizeof(double);
  TRY(find_forces(loads, state));
  loads->kept_work = work_until(loads, state);
  memcpy(loads->kept_force, loads->force, bytes);
  memcpy(loads->kept_position, state->positions, bytes);
  loads->is_started = true;
  return STATUS_OK;
}

static double horizon(const void *self, const FemForesight *foresight, double time, double farthest) {
  const Loads *loads = self;
  for (int i = 0; i < loads->model->load_count; i++)
    farthest =
        fem_load_horizon(loads->model->loads[i].def, loads->acceleration[i], foresight, time, farthest);
  return farthest;
}

static bool follows(const FemLoad *load) {
  return load->triangle_count + load->face_count > 0;
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
    if (!follows(load)) continue;
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
  Loads *loads = self;
  TRY(find_forces(loads, state));
  energy->applied_work += work_until(loads, state);
  return STATUS_OK;
}

static void report(void *self, Record *counters) {
  record_number(counters, "load_work_J", ((const Loads *)self)->kept_work);
}

// The work until now.
static Status save(const void *self, double **values, size_t *count) {
  *count = 1;
  *values = memory_zeroed(*count, sizeof **values);
  if (!*values) return status_no_memory("a checkpoint");
  (*values)[0] = ((const Loads *)self)->kept_work;
  return STATUS_OK;
}

// The way from there on begins at the state that is prepared next.
static Status load(void *self, const double *values, size_t count) {
  Loads *loads = self;
  if (count != 1)
    return status_fail(STATUS_INPUT, "the checkpoint has %zu numbers of the loads' work, not one", count);
  loads->kept_work = values[0];
  loads->is_started = false;
  return STATUS_OK;
}

// A pressure that follows its surface has a stiffness.
static bool is_linear(void *self) {
  const FemModel *model = ((const Loads *)self)->model;
  for (int i = 0; i < model->load_count; i++)
    if (follows(&model->loads[i])) return false;
  return true;
}

static size_t bytes(const void *self) {
  const Loads *loads = self;
  return memory_held(self) + memory_held(loads->kept_force) + memory_held(loads->kept_position) +
         memory_held(loads->force) + memory_held(loads->acceleration);
}

const FemEffectOps fem_effect_loads = {
    .name = "loads",
    .help = "forces, body forces, tractions and pressures from outside, by functions of time",
    .is_wanted = is_wanted,
    .create = create,
    .couple = couple,
    .prepare = prepare,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .horizon = horizon,
    .report = report,
    .is_linear = is_linear,
    .save = save,
    .load = load,
    .bytes = bytes,
    .destroy = destroy,
};
