// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/balance.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/floating.h"

// Forces on a body balance to this share of its weight or, where that is more, to that of what its
// acceleration takes. What is left turns a stiff body that flies, and gives it energy.
static const double BALANCE = 2e-4, BALANCE_OF_INERTIA = 2e-3;
// In a scene without contact whose bodies are held, times this: they cannot turn on.
static const double WITHOUT_CONTACT = 10;
// Nor less than this share of E · edge².
static const double SMALLEST_FORCE = 1e-10;

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
static void sum_up(FemBalance *balance, const FemSystem *system, const FemPart *part,
                   const double *residual) {
  const FemModel *model = system->model;
  for (int b = 0; b < model->body_count; b++) balance->unbalanced[b] = balance->needed[b] = 0;
  int body = 0;
  for (int i = 0; i < part->count; i++) {
    int dof = fem_part_dof(part, i);
    while (dof / 3 >= model->bodies[body].vertex_end) body++;
    balance->unbalanced[body] += fabs(residual[i]);
    balance->needed[body] += fabs(residual[i] + system->forces[dof]);
  }
  ranks()->sum(balance->unbalanced, (size_t)model->body_count);
  ranks()->sum(balance->needed, (size_t)model->body_count);
}

double fem_balance_excess(FemBalance *balance, FemSystem *system, const FemPart *part,
                          const double *residual) {
  const FemModel *model = system->model;
  void *contact = fem_system_effect(system, &fem_effect_contact);
  const double *forces = contact ? contact_system_forces(fem_effect_contact_system(contact)) : NULL;
  double worst = 0, gravity = model->scene->has_gravity ? vec3_length(vec3_at(model->scene->gravity)) : 0;
  const bool is_strict = forces || fem_model_floats(model, part->numbering->released);
  sum_up(balance, system, part, residual);
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double weight = gravity * body->mass;
    if (forces && !(gravity > 0)) weight = pressed_on(forces, body);
    double needed = fmax(BALANCE * weight, BALANCE_OF_INERTIA * balance->needed[b]);
    double floor = SMALLEST_FORCE * body->material.young * model->edge * model->edge;
    double allowed = fmax(is_strict ? needed : WITHOUT_CONTACT * needed, floor);
    worst = fmax(worst, balance->unbalanced[b] / allowed);
  }
  return worst;
}
