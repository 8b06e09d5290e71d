// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/formulas.h"

#include <math.h>
#include <stdio.h>

static Status check(const FemSceneDef *scene, const Expression *formula, const char *whose, const char *name,
                    double time) {
  if (!formula) return STATUS_OK;
  ExpressionValue found = expression_eval(formula, time);
  if (isfinite(found.value)) return STATUS_OK;
  char place[64] = "";
  if (formula->line > 0) snprintf(place, sizeof place, ":%d:%d", formula->line, formula->column);
  return status_fail(STATUS_INPUT,
                     "%s%s: %s '%s': the formula '%s' is no number at t = %.9g s; see the functions in "
                     "the manual, scene.md#formulas",
                     scene->path ? scene->path : "scene", place, whose, name, formula->text, time);
}

static Status check_motion(const FemSceneDef *scene, const FemConstraintDef *motion, const char *whose,
                           const char *name, double time) {
  double at = fmin(time, motion->until);
  if (motion->release > 0 && time >= motion->release) return STATUS_OK;
  for (int c = 0; c < 3; c++) TRY(check(scene, motion->formula[c], whose, name, at));
  return check(scene, motion->angle, whose, name, at);
}

Status fem_formulas_check(const FemModel *model, double time) {
  const FemSceneDef *scene = model->scene;
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    for (int i = 0; i < body->driven_count; i++)
      TRY(check_motion(scene, &body->driven[i], "body", body->name, time));
    for (int i = 0; i < body->load_count; i++)
      TRY(check(scene, body->loads[i].factor, "a load on", body->name, time));
  }
  for (int o = 0; o < scene->obstacle_count; o++)
    TRY(check_motion(scene, &scene->obstacles[o].motion, "obstacle", scene->obstacles[o].name, time));
  return STATUS_OK;
}
