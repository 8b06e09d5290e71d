// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/balance.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/model/limits.h"
#include "fem/model/parts.h"

Status fem_balance_create(FemBalance *balance, int body_count) {
  balance->bodies = memory_zeroed((size_t)body_count, sizeof *balance->bodies);
  return balance->bodies ? STATUS_OK : status_no_memory("the integrator");
}

void fem_balance_destroy(FemBalance *balance) {
  memory_free(balance->bodies);
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

// The sums of each body.
static void sum_up(FemBalance *balance, const FemModel *model, const FemPart *part, const FemState *state,
                   const double *forces, const double *residual) {
  const size_t numbers = sizeof(FemBalanceBody) / sizeof(double);
  Motion motion;
  for (int b = 0; b < model->body_count; b++) balance->bodies[b] = (FemBalanceBody){0};
  for (int i = 0, body = -1; i < part->count; i++) {
    int dof = fem_part_dof(part, i), c = dof % 3;
    while (body < 0 || dof / 3 >= model->bodies[body].vertex_end)
      motion = motion_of(model, &model->bodies[++body], state);
    FemBalanceBody *sums = &balance->bodies[body];
    double needed = fabs(residual[i] + forces[dof]), turn[3], relative[3];
    vec3_store(turn, vec3_cross(motion.spin, vec3_sub(vec3_at(state->positions + dof - c), motion.centre)));
    vec3_store(relative, vec3_sub(vec3_at(state->velocities + dof - c), motion.velocity));
    sums->unbalanced += fabs(residual[i]);
    sums->needed += needed;
    sums->power += residual[i] * turn[c];
    sums->turnover += needed * fabs(relative[c]);
  }
  ranks()->sum(&balance->bodies->unbalanced, numbers * (size_t)model->body_count); // numbers only
}

static double young_of(const FemMaterial *material) {
  return material->young;
}

double fem_balance_excess(FemBalance *balance, const FemModel *model, const FemPart *part,
                          const FemState *state, const double *forces, const double *pressing,
                          const double *residual) {
  double worst = 0, gravity = model->scene->has_gravity ? vec3_length(vec3_at(model->scene->gravity)) : 0;
  const bool has_turns = !fem_model_has_linear_materials(model); // Hooke's law in fixed axes knows none
  sum_up(balance, model, part, state, forces, residual);
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double weight = gravity * body->mass;
    if (pressing && !(gravity > 0)) weight = pressed_on(pressing, body);
    const FemBalanceBody *sums = &balance->bodies[b];
    // Without weight: rounding of the force by which an element is strained by time.tolerance.
    double young = fem_model_parts_least(model, b, young_of);
    double rounding = FEM_ROUNDING * model->scene->tolerance * young * model->edge * model->edge;
    double least = fmax(FEM_BALANCE * weight, rounding), rest = sums->unbalanced;
    double excess = rest / fmax(least, FEM_BALANCE_OF_INERTIA * sums->needed);
    if (has_turns && rest > least && sums->power != 0)
      excess = fmax(excess, fabs(sums->power) / (FEM_BALANCE_OF_TURN * sums->turnover));
    if (!(excess <= worst)) worst = isnan(excess) ? INFINITY : excess;
  }
  return worst;
}
