// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/parameter.h"

#include "base/memory.h"
#include "fem/effect/gravity.h"

static Status check_stiffness(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  if (!contact->is_on) return status_fail(STATUS_INPUT, "contact.stiffness: the scene has no contact");
  if (contact->law.law.kind != CONTACT_LAW_LINEAR)
    return status_fail(STATUS_INPUT, "contact.stiffness does not act: contact.law stands in its place");
  if (contact->stiffness == 0)
    return status_fail(STATUS_INPUT, "contact.stiffness is chosen from the bodies: write its value into the "
                                     "scene (`tetlap check` says it) for a derivative by it");
  for (int i = 0; i < contact->pair_count; i++)
    if (contact->pairs[i].stiffness > 0 || contact->pairs[i].law.law.kind != CONTACT_LAW_LINEAR)
      return status_fail(STATUS_INPUT,
                         "contact.stiffness: contact.pairs[%d] has its own stiffness or law, which no "
                         "derivative is known by",
                         i);
  return STATUS_OK;
}

static Status check_young(const FemModel *model, int body) {
  const FemModelBody *at = &model->bodies[body];
  if (at->material.fibre_stiffness > 0)
    return status_fail(STATUS_INPUT, "bodies.%s.material.young: a body with fibres has no derivative by it",
                       at->name);
  if (model->scene->contact.is_on && model->scene->contact.stiffness == 0)
    return status_fail(STATUS_INPUT,
                       "bodies.%s.material.young: contact.stiffness is chosen from it; write its value into "
                       "the scene (`tetlap check` says it) for a derivative at fixed stiffness",
                       at->name);
  return STATUS_OK;
}

Status fem_parameter_check(const FemModel *model, const FemParameter *parameter) {
  switch (parameter->kind) {
  case FEM_PARAMETER_YOUNG:
    return check_young(model, parameter->body);
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return check_stiffness(model);
  case FEM_PARAMETER_DENSITY:
  case FEM_PARAMETER_GRAVITY:
    break;
  }
  if (model->scene->has_gravity) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: the scene has no effects.gravity",
                     parameter->kind == FEM_PARAMETER_DENSITY ? "a density does not act" : "gravity");
}

double fem_parameter_value(const FemModel *model, const FemParameter *parameter) {
  const FemMaterial *material = &model->bodies[parameter->body].material;
  switch (parameter->kind) {
  case FEM_PARAMETER_YOUNG:
    return material->young;
  case FEM_PARAMETER_DENSITY:
    return material->density;
  case FEM_PARAMETER_GRAVITY:
    return model->scene->gravity[parameter->component];
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return model->scene->contact.stiffness;
  }
  return 0;
}

// force += scale · what the effect gives, on vertices from `begin` to before `end`.
static Status add_scaled(FemSystem *system, const FemEffectOps *effect, const FemState *state, double scale,
                         int begin, int end, double *force) {
  void *self = fem_system_effect(system, effect);
  if (!self) return STATUS_OK;
  double *whole = memory_zeroed(3 * (size_t)system->model->vertex_count, sizeof *whole);
  if (!whole) return status_no_memory("a derivative of forces");
  Status status = effect->add_force(self, state, whole);
  for (size_t i = 3 * (size_t)begin; !status && i < 3 * (size_t)end; i++) force[i] += scale * whole[i];
  memory_free(whole);
  return status;
}

static void add_weight(const FemModel *model, const double by[3], int begin, int end, double *force) {
  for (int a = begin; a < end; a++)
    for (int c = 0; c < 3; c++) force[3 * (size_t)a + (size_t)c] += model->mass[a] * by[c];
}

Status fem_parameter_add_force(const FemParameter *parameter, FemSystem *system, const FemState *state,
                               double *force) {
  const FemModel *model = system->model;
  const FemModelBody *body = &model->bodies[parameter->body];
  int begin = body->vertex_begin, end = body->vertex_end;
  double value = fem_parameter_value(model, parameter), share = fem_gravity_share(model, state->time);
  double by[3] = {0};
  switch (parameter->kind) {
  case FEM_PARAMETER_YOUNG:
    TRY(add_scaled(system, &fem_effect_elasticity, state, 1 / value, begin, end, force));
    return add_scaled(system, &fem_effect_volume, state, 1 / value, begin, end, force);
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return add_scaled(system, &fem_effect_contact, state, 1 / value, 0, model->vertex_count, force);
  case FEM_PARAMETER_DENSITY:
    for (int c = 0; c < 3; c++) by[c] = share * model->scene->gravity[c] / value;
    add_weight(model, by, begin, end, force);
    break;
  case FEM_PARAMETER_GRAVITY:
    by[parameter->component] = share;
    add_weight(model, by, 0, model->vertex_count, force);
    break;
  }
  return STATUS_OK;
}
