// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/balance.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/model/limits.h"
#include "fem/model/parts.h"
#include "fem/sparse/vector.h"

Status fem_balance_create(FemBalance *balance, int body_count) {
  balance->bodies = memory_zeroed((size_t)body_count, sizeof *balance->bodies);
  balance->given = memory_zeroed((size_t)body_count, sizeof *balance->given);
  balance->begin = memory_zeroed((size_t)body_count + 1, sizeof *balance->begin);
  return balance->bodies && balance->given && balance->begin ? STATUS_OK : status_no_memory("the integrator");
}

void fem_balance_destroy(FemBalance *balance) {
  memory_free(balance->bodies);
  memory_free(balance->given);
  memory_free(balance->begin);
}

// Of a body's vertices in contact.
static double pressed_on(const double *forces, const FemModelBody *body) {
  double sum = 0;
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    sum += vec3_length(vec3_at(forces + 3 * (size_t)a));
  return sum;
}

// How a body moves as a whole.
typedef struct Motion {
  Vec3 centre, velocity; // of the mass [m], [m/s]
  Vec3 spin;             // inertia⁻¹ · angular momentum, about the centre [rad/s]
} Motion;

static Motion motion_of(const FemModel *model, const FemModelBody *body, const FemState *state) {
  Vec3 moment = {0, 0, 0}, momentum = {0, 0, 0}, angular = {0, 0, 0}, rows[3] = {{0, 0, 0}};
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    moment = vec3_add(moment, vec3_scale(model->mass[a], vec3_at(state->positions + 3 * (size_t)a)));
    momentum = vec3_add(momentum, vec3_scale(model->mass[a], vec3_at(state->velocities + 3 * (size_t)a)));
  }
  Motion motion = {vec3_scale(1 / body->mass, moment), vec3_scale(1 / body->mass, momentum), {0, 0, 0}};
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(state->positions + 3 * (size_t)a), motion.centre),
         relative = vec3_sub(vec3_at(state->velocities + 3 * (size_t)a), motion.velocity);
    double d[3], square = model->mass[a] * vec3_dot(arm, arm);
    angular = vec3_add(angular, vec3_scale(model->mass[a], vec3_cross(arm, relative)));
    vec3_store(d, arm);
    for (int k = 0; k < 3; k++) {
      Vec3 row = vec3_scale(-model->mass[a] * d[k], arm);
      rows[k] = vec3_add(
          rows[k], (Vec3){row.x + square * (k == 0), row.y + square * (k == 1), row.z + square * (k == 2)});
    }
  }
  Vec3 columns[3] = {vec3_cross(rows[1], rows[2]), vec3_cross(rows[2], rows[0]),
                     vec3_cross(rows[0], rows[1])};
  Vec3 spin = {vec3_dot(angular, columns[0]), vec3_dot(angular, columns[1]), vec3_dot(angular, columns[2])};
  motion.spin = vec3_scale(1 / vec3_dot(rows[0], columns[0]), spin);
  return motion;
}

// This rank's unknowns are in the order of the bodies.
static void divide(FemBalance *balance, const FemModel *model, const FemPart *part) {
  for (int b = 0, end = 0; b < model->body_count; b++) {
    while (end < part->count && fem_part_dof(part, end) / 3 < model->bodies[b].vertex_end) end++;
    balance->begin[b + 1] = end;
  }
}

static void add_forces(FemBalanceBody *sums, const FemPart *part, int begin, int end, const double *forces,
                       const double *residual) {
  for (int i = begin; i < end; i++) {
    sums->unbalanced += fabs(residual[i]);
    sums->needed += fabs(residual[i] + forces[fem_part_dof(part, i)]);
  }
}

static void add_power(FemBalanceBody *sums, const FemModel *model, const FemPart *part, int begin, int end,
                      const Motion *motion, const FemState *state, const double *forces,
                      const double *residual) {
  for (int i = begin; i < end; i++) {
    int dof = fem_part_dof(part, i), c = dof % 3;
    double turn[3], relative[3];
    vec3_store(turn, vec3_cross(motion->spin, vec3_sub(vec3_at(state->positions + dof - c), motion->centre)));
    vec3_store(relative, vec3_sub(vec3_at(state->velocities + dof - c), motion->velocity));
    sums->power += residual[i] * turn[c];
    sums->turnover += fabs(residual[i] + forces[dof]) * fabs(relative[c]);
    sums->energy += 0.5 * model->mass[dof / 3] * relative[c] * relative[c];
  }
}

static double young_of(const FemMaterial *material) {
  return material->young;
}

// Numbers only.
static void add_over_ranks(FemBalance *balance, const FemModel *model) {
  ranks()->sum(&balance->bodies->unbalanced,
               sizeof(FemBalanceBody) / sizeof(double) * (size_t)model->body_count);
}

// What is left that needs no balance: a share of the weight, or of what presses where there is none, or
// rounding of the force by which an element is strained by time.tolerance.
static double least_of(const FemModel *model, int b, const double *pressing) {
  const FemModelBody *body = &model->bodies[b];
  double gravity = model->scene->has_gravity ? vec3_length(vec3_at(model->scene->gravity)) : 0;
  double weight = gravity * body->mass;
  if (pressing && !(gravity > 0)) weight = pressed_on(pressing, body);
  double young = fem_model_parts_least(model, b, young_of);
  return fmax(FEM_BALANCE * weight,
              FEM_ROUNDING * model->scene->tolerance * young * model->edge * model->edge);
}

// The largest excess of what is left, infinite where one is no number.
static double excess_of_forces(FemBalance *balance, const FemModel *model, const FemPart *part,
                               const double *forces, const double *pressing, const double *residual) {
  double worst = 0;
  divide(balance, model, part);
#pragma omp parallel for schedule(dynamic) if (part->count > FEM_VECTOR_LONG)
  for (int b = 0; b < model->body_count; b++) {
    balance->bodies[b] = (FemBalanceBody){0};
    add_forces(&balance->bodies[b], part, balance->begin[b], balance->begin[b + 1], forces, residual);
  }
  add_over_ranks(balance, model);
  for (int b = 0; b < model->scene->body_count; b++) {
    FemBalanceBody *sums = &balance->bodies[b];
    double least = least_of(model, b, pressing);
    double excess = sums->unbalanced / fmax(least, FEM_BALANCE_OF_INERTIA * sums->needed);
    sums->is_within = sums->unbalanced <= least;
    if (!(excess <= worst)) worst = isnan(excess) ? INFINITY : excess;
  }
  return worst;
}

// The same of its power on rotations, where the forces balance and it adds to what was given already.
static double excess_of_power(FemBalance *balance, const FemModel *model, const FemPart *part,
                              const FemState *state, const double *forces, const double *residual) {
  double worst = 0;
#pragma omp parallel for schedule(dynamic) if (part->count > FEM_VECTOR_LONG)
  for (int b = 0; b < model->scene->body_count; b++) {
    FemBalanceBody *sums = &balance->bodies[b];
    bool is_within = sums->is_within != 0;
    *sums = (FemBalanceBody){0};
    if (is_within) continue;
    Motion motion = motion_of(model, &model->bodies[b], state);
    add_power(sums, model, part, balance->begin[b], balance->begin[b + 1], &motion, state, forces, residual);
  }
  add_over_ranks(balance, model);
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemBalanceBody *sums = &balance->bodies[b];
    bool adds_up = balance->given[b] * sums->power > 0 &&
                   fabs(balance->given[b]) > FEM_RESERVE * FEM_ENERGY * sums->energy;
    double allowed = FEM_BALANCE_OF_TURN * sums->turnover;
    if (adds_up && fabs(sums->power) > worst * allowed) worst = fabs(sums->power) / allowed;
  }
  return worst;
}

double fem_balance_excess(FemBalance *balance, const FemModel *model, const FemPart *part,
                          const FemState *state, const double *forces, const double *pressing,
                          const double *residual) {
  double excess = excess_of_forces(balance, model, part, forces, pressing, residual);
  // Hooke's law in fixed axes knows no rotations.
  if (!(excess <= 1) || fem_model_has_linear_materials(model)) return excess;
  return fmax(excess, excess_of_power(balance, model, part, state, forces, residual));
}

void fem_balance_keep(FemBalance *balance, const FemModel *model, double step) {
  for (int b = 0; b < model->body_count; b++) balance->given[b] += step * balance->bodies[b].power;
}
