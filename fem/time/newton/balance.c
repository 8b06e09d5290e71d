// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/balance.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/model/limits.h"
#include "fem/model/parts.h"

Status fem_balance_create(FemBalance *balance, int body_count) {
  balance->unbalanced = memory_zeroed((size_t)body_count, sizeof(double));
  balance->needed = memory_zeroed((size_t)body_count, sizeof(double));
  return balance->unbalanced && balance->needed ? STATUS_OK : status_no_memory("the integrator");
}

void fem_balance_destroy(FemBalance *balance) {
  memory_free(balance->unbalanced);
  memory_free(balance->needed);
}

// Of a body's vertices in contact.
static double pressed_on(const double *forces, const FemModelBody *body) {
  double sum = 0;
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    sum += vec3_length(vec3_at(forces + 3 * (size_t)a));
  return sum;
}

// Σ |r|, and Σ m |v̇| = Σ |r + f|, of each body.
static void sum_up(FemBalance *balance, const FemModel *model, const FemPart *part, const double *forces,
                   const double *residual) {
  for (int b = 0; b < model->body_count; b++) balance->unbalanced[b] = balance->needed[b] = 0;
  int body = 0;
  for (int i = 0; i < part->count; i++) {
    int dof = fem_part_dof(part, i);
    while (dof / 3 >= model->bodies[body].vertex_end) body++;
    balance->unbalanced[body] += fabs(residual[i]);
    balance->needed[body] += fabs(residual[i] + forces[dof]);
  }
  ranks()->sum(balance->unbalanced, (size_t)model->body_count);
  ranks()->sum(balance->needed, (size_t)model->body_count);
}

static double young_of(const FemMaterial *material) {
  return material->young;
}

double fem_balance_excess(FemBalance *balance, const FemModel *model, const FemPart *part,
                          const double *forces, const double *pressing, const double *residual) {
  double worst = 0, gravity = model->scene->has_gravity ? vec3_length(vec3_at(model->scene->gravity)) : 0;
  sum_up(balance, model, part, forces, residual);
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double weight = gravity * body->mass;
    if (pressing && !(gravity > 0)) weight = pressed_on(pressing, body);
    double needed = fmax(FEM_BALANCE * weight, FEM_BALANCE_OF_INERTIA * balance->needed[b]);
    // Without either: rounding of the force by which an element is strained by time.tolerance.
    double young = fem_model_parts_least(model, b, young_of);
    double least = FEM_ROUNDING * model->scene->tolerance * young * model->edge * model->edge;
    double excess = balance->unbalanced[b] / fmax(needed, least);
    if (!(excess <= worst)) worst = isnan(excess) ? INFINITY : excess;
  }
  return worst;
}
