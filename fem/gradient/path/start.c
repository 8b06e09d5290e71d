// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/start.h"

#include <string.h>

#include "base/memory.h"
#include "fem/gradient/shape.h"
#include "fem/model/floating.h"
#include "fem/model/parts.h"

// ∂c/∂p = Σ (∂m/∂p (X − c) + m ∂X/∂p) / M.
static Status find_shift(const FemModel *model, const FemParameter *parameter, const double *rests,
                         Vec3 *shift) {
  const FemModelBody *body = &model->bodies[parameter->body];
  Vec3 centre = fem_model_centre(model, body);
  double *masses = memory_zeroed((size_t)model->vertex_count, sizeof *masses);
  if (!masses) return status_no_memory("the velocities at the start");
  Status status = STATUS_OK;
  if (parameter->kind == FEM_PARAMETER_DENSITY) fem_model_parts_spread(model, parameter->part, masses);
  if (fem_parameter_is_of_shape(parameter)) status = fem_shape_add_masses(model, rests, masses);
  *shift = (Vec3){0, 0, 0};
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * (size_t)a), centre);
    *shift = vec3_add(*shift, vec3_scale(masses[a] / body->mass, arm));
    *shift = vec3_add(*shift, vec3_scale(model->mass[a] / body->mass, vec3_at(rests + 3 * (size_t)a)));
  }
  memory_free(masses);
  return status;
}

// v = ω × (x − c) as x and c move.
static Status turn(const FemModel *model, const FemParameter *parameter, const double *rests, double *rates) {
  const FemModelBody *body = &model->bodies[parameter->body];
  Vec3 spin = vec3_at(model->scene->bodies[parameter->body].spin), shift = {0, 0, 0};
  if (spin.x == 0 && spin.y == 0 && spin.z == 0) return STATUS_OK;
  TRY(find_shift(model, parameter, rests, &shift));
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    vec3_store(rates + 3 * (size_t)a, vec3_cross(spin, vec3_sub(vec3_at(rests + 3 * (size_t)a), shift)));
  return STATUS_OK;
}

Status fem_start_find(const FemModel *model, const FemParameter *parameter, const double *rests,
                      double *rates) {
  memset(rates, 0, 3 * (size_t)model->vertex_count * sizeof *rates);
  if (parameter->body < 0 || model->start) return STATUS_OK;
  if (parameter->kind == FEM_PARAMETER_DENSITY || fem_parameter_moves_rest(parameter))
    return turn(model, parameter, rests, rates);
  const FemModelBody *body = &model->bodies[parameter->body];
  Vec3 centre = fem_model_centre(model, body), common = {0, 0, 0}, spin = {0, 0, 0};
  double unit[3] = {0, 0, 0};
  if (parameter->kind != FEM_PARAMETER_START && parameter->kind != FEM_PARAMETER_START_SPIN) return STATUS_OK;
  unit[parameter->component] = 1;
  if (parameter->kind == FEM_PARAMETER_START)
    common = vec3_at(unit);
  else
    spin = vec3_at(unit);
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * (size_t)a), centre);
    vec3_store(rates + 3 * (size_t)a, vec3_add(common, vec3_cross(spin, arm)));
  }
  return STATUS_OK;
}
