// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/start.h"

#include <string.h>

#include "base/memory.h"
#include "fem/model/floating.h"
#include "fem/model/parts.h"

// ∂c/∂ρ = Σ ∂m/∂ρ (x − c) / M.
static Status find_shift(const FemModel *model, const FemModelBody *body, int part, Vec3 centre,
                         Vec3 *shift) {
  double *masses = memory_zeroed((size_t)model->vertex_count, sizeof *masses);
  if (!masses) return status_no_memory("the velocities at the start");
  fem_model_parts_spread(model, part, masses);
  *shift = (Vec3){0, 0, 0};
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * (size_t)a), centre);
    *shift = vec3_add(*shift, vec3_scale(masses[a] / body->mass, arm));
  }
  memory_free(masses);
  return STATUS_OK;
}

Status fem_start_find(const FemModel *model, const FemParameter *parameter, double *rates) {
  memset(rates, 0, 3 * (size_t)model->vertex_count * sizeof *rates);
  if (parameter->body < 0 || model->start) return STATUS_OK;
  const FemModelBody *body = &model->bodies[parameter->body];
  Vec3 centre = fem_model_centre(model, body), common = {0, 0, 0}, spin = {0, 0, 0};
  double unit[3] = {0, 0, 0};
  unit[parameter->component] = 1;
  switch (parameter->kind) {
  case FEM_PARAMETER_START:
    common = vec3_at(unit);
    break;
  case FEM_PARAMETER_START_SPIN:
    spin = vec3_at(unit);
    break;
  case FEM_PARAMETER_DENSITY:
    TRY(find_shift(model, body, parameter->part, centre, &common));
    common = vec3_cross(common, vec3_at(model->scene->bodies[parameter->body].spin));
    break;
  default:
    return STATUS_OK;
  }
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * (size_t)a), centre);
    vec3_store(rates + 3 * (size_t)a, vec3_add(common, vec3_cross(spin, arm)));
  }
  return STATUS_OK;
}
