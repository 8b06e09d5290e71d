// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/patch.h"

#include <math.h>

#include "base/vec3.h"
#include "fem/scene/drive.h"

enum { SAMPLES = 65 }; // of a motion or a load's factor in time

static double sample_time(const FemModel *model, int k) {
  return model->scene->end * k / (SAMPLES - 1);
}

static double travel_of(const FemModel *model, const FemConstraintDef *def, const double rest[3]) {
  double from[3], to[3], velocity[3], farthest = 0;
  if (fem_drive_is_still(def)) return 0;
  fem_drive_point(def, 0, rest, from, velocity);
  for (int k = 1; k < SAMPLES; k++) {
    fem_drive_point(def, sample_time(model, k), rest, to, velocity);
    double far = vec3_length(vec3_sub(vec3_at(to), vec3_at(from)));
    if (far > farthest) farthest = far;
  }
  return farthest;
}

static const FemObstacleDef *shape_of(const FemModel *model, int party) {
  int number = model->body_count;
  for (int o = 0; o < model->scene->obstacle_count; o++)
    if (model->scene->obstacles[o].kind != FEM_OBSTACLE_MESH && number++ == party)
      return &model->scene->obstacles[o];
  return NULL;
}

double fem_patch_travel(const FemModel *model, int party) {
  double farthest = 0;
  const FemObstacleDef *shape = shape_of(model, party);
  if (shape) return travel_of(model, &shape->motion, shape->point);
  const FemModelBody *body = &model->bodies[party];
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    double least = INFINITY;
    for (int i = 0; i < driver->dof_count; i++) {
      int vertex = driver->dofs[i] / 3;
      if (vertex < body->vertex_begin || vertex >= body->vertex_end) break;
      least = fmin(least, travel_of(model, driver->def, model->rest + 3 * (size_t)vertex));
    }
    if (least < INFINITY) farthest = fmax(farthest, least);
  }
  return farthest;
}

static double factor_of(const FemModel *model, const FemLoadDef *def) {
  double largest = 0, factor;
  for (int k = 0; k < SAMPLES; k++)
    if (!fem_load_factor(def, sample_time(model, k), &factor)) largest = fmax(largest, fabs(factor));
  return largest;
}

double fem_patch_load(const FemModel *model, int party) {
  double sum = 0;
  if (party >= model->scene->body_count) return 0;
  const FemModelBody *of = &model->bodies[party];
  for (int l = 0; l < model->load_count; l++) {
    const FemLoad *load = &model->loads[l];
    Vec3 force = {0, 0, 0};
    if (!load->force || load->vertex_count == 0 || load->vertices[0] < of->vertex_begin ||
        load->vertices[0] >= of->vertex_end)
      continue;
    for (int v = 0; v < load->vertex_count; v++) force = vec3_add(force, vec3_at(load->force + 3 * v));
    sum += factor_of(model, load->def) * vec3_length(force);
  }
  if (model->scene->has_gravity && model->scene->is_static)
    sum += of->mass * vec3_length(vec3_at(model->scene->gravity));
  return sum;
}

double fem_patch_radius(double curvature, double modulus, double approach, double force, double energy) {
  double struck = pow(15 * energy * sqrt(curvature) / (8 * modulus), 0.4);
  double pressed = cbrt(3 * force / (4 * modulus * curvature));
  return fmax(pressed, sqrt(fmax(approach, struck) / curvature));
}
