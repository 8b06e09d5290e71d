// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/check.h"

#include <math.h>

#include "fem/gradient/change.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/laws.h"

static Status check_viscosity(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->contact.is_on && scene->contact.viscosity > 0)
    return status_fail(STATUS_INPUT, "contact.viscosity: its matrix is not exact by positions");
  if (scene->contact.is_on && scene->contact.rest_is_on)
    return status_fail(STATUS_INPUT, "contact.rest: bodies that fall asleep have no gradient");
  return STATUS_OK;
}

static Status check_released(const FemModel *model) {
  for (int d = 0; d < model->driver_count; d++)
    if (model->drivers[d].def->release > 0 || model->drivers[d].def->is_external)
      return status_fail(STATUS_INPUT, "what is released or moved from outside has no gradient in a motion");
  return STATUS_OK;
}

static Status check_motion(const FemModel *model, const FemGradientDef *def) {
  TRY(check_viscosity(model));
  TRY(check_released(model));
  for (int p = 0; p < def->parameter_count; p++)
    if (model->start && fem_parameter_moves_rest(&def->parameters[p]))
      return status_fail(STATUS_INPUT, "start: a run that goes on from another has no derivative by a body's "
                                       "place or shape");
  return STATUS_OK;
}

static bool rubs_on(const FemModel *model, int party) {
  for (int b = 0; b < model->body_count; b++)
    if (fem_compliance_friction(model, b, party).coefficient > 0) return true;
  return false;
}

static Status check_pairs(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (fem_laws_are_wanted(&scene->contact))
    return status_fail(STATUS_INPUT, "contact.law: with friction it has no gradient");
  for (int o = 0; o < scene->obstacle_count; o++)
    if (scene->obstacles[o].kind == FEM_OBSTACLE_BALL && rubs_on(model, fem_change_party(model, o)))
      return status_fail(STATUS_INPUT,
                         "obstacle '%s': friction on a sphere has no gradient; a body or a mesh obstacle has",
                         scene->obstacles[o].name);
  return STATUS_OK;
}

static Status check_friction(const FemModel *model, const FemGradientDef *def) {
  if (!fem_gradient_has_friction(model)) return STATUS_OK;
  if (fem_scene_has_breakaway(&model->scene->contact))
    return status_fail(STATUS_INPUT,
                       "contact.friction.static: friction that is larger at rest has no gradient: "
                       "a run may break away sooner or later");
  TRY(check_pairs(model));
  for (int p = 0; p < def->parameter_count; p++)
    if (def->parameters[p].kind == FEM_PARAMETER_SPIN && def->parameters[p].obstacle >= 0)
      return status_fail(STATUS_INPUT, "with friction there is no derivative by the spin of an obstacle");
  return STATUS_OK;
}

static Status check_start(const FemModel *model) {
  bool yields = fem_gradient_yields(model);
  if (!model->start || !(yields || fem_gradient_has_friction(model))) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s a run that goes on from another has no gradient",
                     yields ? "start: with plasticity" : "start: with friction");
}

Status fem_path_check(const FemModel *model, const FemGradientDef *def) {
  if (!model->scene->is_static) TRY(check_motion(model, def));
  TRY(check_start(model));
  return check_friction(model, def);
}

static bool has_step(const FemReplaySteps *steps, const FemModel *model, const FemTerm *term) {
  for (int k = 1; k < steps->count; k++)
    if (fem_term_is_due(term, model, steps->times[k])) return true;
  return false;
}

Status fem_path_check_times(const FemModel *model, const FemGradientDef *def, const FemReplaySteps *steps) {
  for (int g = 0; g < def->goal_count; g++)
    for (int t = 0; t < def->goals[g].term_count; t++) {
      const FemTerm *term = &def->goals[g].terms[t];
      if (!has_step(steps, model, term))
        return status_fail(STATUS_INPUT, "no step of the run ends at t = %.9g s",
                           fmin(term->time, model->scene->end));
    }
  return STATUS_OK;
}
