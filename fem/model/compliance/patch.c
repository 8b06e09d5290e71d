// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/patch.h"

#include <math.h>

#include "base/vec3.h"
#include "fem/model/limits.h"
#include "fem/scene/drive.h"

enum { SAMPLES = 129 }; // of a motion or a load's factor in time

// The k-th time at which a motion or a factor is sampled: the end, then times that no period shares,
// multiples of the golden ratio.
static double sample_time(const FemModel *model, int k) {
  return model->scene->end * (k == 0 ? 1 : fmod(k * 0.6180339887498949, 1));
}

// After these samples, the time of a row of a table whose rows have `width` numbers, within the run.
static double table_time(const FemModel *model, const double *table, int width, int row) {
  return fmin(fmax(table[(size_t)width * (size_t)row], 0), model->scene->end);
}

static double travel_of(const FemModel *model, const FemConstraintDef *def, const double rest[3]) {
  double from[3], to[3], velocity[3], farthest = 0;
  if (fem_drive_is_still(def)) return 0;
  fem_drive_point(def, 0, rest, from, velocity);
  for (int k = 0; k < SAMPLES + def->table_count; k++) {
    double time = k < SAMPLES ? sample_time(model, k) : table_time(model, def->table, 4, k - SAMPLES);
    fem_drive_point(def, time, rest, to, velocity);
    double far = vec3_length(vec3_sub(vec3_at(to), vec3_at(from)));
    if (far > farthest) farthest = far;
  }
  return farthest;
}

// Of a body's driven vertices, at rest.
typedef struct Driven {
  int count;
  Vec3 low, high, sum;
} Driven;

static void add_driven(Driven *driven, const double rest[3]) {
  Vec3 x = vec3_at(rest);
  if (driven->count++ == 0) driven->low = driven->high = x;
  driven->low = (Vec3){fmin(driven->low.x, x.x), fmin(driven->low.y, x.y), fmin(driven->low.z, x.z)};
  driven->high = (Vec3){fmax(driven->high.x, x.x), fmax(driven->high.y, x.y), fmax(driven->high.z, x.z)};
  driven->sum = vec3_add(driven->sum, x);
}

// The point of the axis next to their mean moves as little as any; INFINITY: it is outside the box round
// them.
static double travel_of_axis(const FemModel *model, const FemConstraintDef *def, const Driven *driven) {
  Vec3 centre = vec3_at(def->centre), axis = vec3_at(def->axis);
  if (!(def->spin != 0 || def->turns) || driven->count == 0) return INFINITY;
  Vec3 arm = vec3_sub(vec3_scale(1.0 / driven->count, driven->sum), centre);
  Vec3 foot = vec3_add(centre, vec3_scale(vec3_dot(axis, arm) / vec3_dot(axis, axis), axis));
  double point[3] = {foot.x, foot.y, foot.z}, low[3], high[3];
  vec3_store(low, driven->low), vec3_store(high, driven->high);
  double slack = FEM_ROUNDING * vec3_length(vec3_sub(driven->high, driven->low));
  for (int c = 0; c < 3; c++)
    if (!(point[c] >= low[c] - slack && point[c] <= high[c] + slack)) return INFINITY;
  return travel_of(model, def, point);
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
    Driven driven = {0};
    for (int i = 0; i < driver->dof_count; i++) {
      int vertex = driver->dofs[i] / 3;
      if (vertex < body->vertex_begin || vertex >= body->vertex_end) break;
      least = fmin(least, travel_of(model, driver->def, model->rest + 3 * (size_t)vertex));
      add_driven(&driven, model->rest + 3 * (size_t)vertex);
    }
    least = fmin(least, travel_of_axis(model, driver->def, &driven));
    if (least < INFINITY) farthest = fmax(farthest, least);
  }
  return farthest;
}

static double factor_of(const FemModel *model, const FemLoadDef *def) {
  double largest = 0, factor;
  for (int k = 0; k < SAMPLES + def->table_count; k++) {
    double time = k < SAMPLES ? sample_time(model, k) : table_time(model, def->table, 2, k - SAMPLES);
    if (!fem_load_factor(def, time, &factor)) largest = fmax(largest, fabs(factor));
  }
  return largest;
}

// Twice the area vector of a triangle of the model at rest.
static Vec3 face_vector(const FemModel *model, const int corners[3]) {
  Vec3 x[3];
  for (int v = 0; v < 3; v++) x[v] = vec3_at(model->rest + 3 * (size_t)corners[v]);
  return vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0]));
}

// A vertex that carries the load; −1: none does, or it has no resultant.
static int carrier_of(const FemLoad *load) {
  if (load->force && load->vertex_count > 0) return load->vertices[0];
  if (load->triangle_count > 0) return load->triangles[0][0];
  return load->face_count > 0 ? load->faces[0][0] : -1;
}

// At factor 1; of a pressure that follows its surface, where that is at rest [N].
static Vec3 resultant_of(const FemModel *model, const FemLoad *load) {
  Vec3 force = {0, 0, 0}, area = {0, 0, 0};
  for (int v = 0; load->force && v < load->vertex_count; v++)
    force = vec3_add(force, vec3_at(load->force + 3 * (size_t)v));
  for (int k = 0; k < load->triangle_count; k++)
    area = vec3_add(area, face_vector(model, load->triangles[k]));
  for (int k = 0; k < load->face_count; k++) area = vec3_add(area, face_vector(model, load->faces[k]));
  return vec3_add(force, vec3_scale(-0.5 * load->def->pressure, area));
}

double fem_patch_load(const FemModel *model, int party) {
  double sum = 0;
  if (party >= model->scene->body_count) return 0;
  const FemModelBody *of = &model->bodies[party];
  for (int l = 0; l < model->load_count; l++) {
    const FemLoad *load = &model->loads[l];
    int carrier = carrier_of(load);
    if (carrier < of->vertex_begin || carrier >= of->vertex_end) continue;
    sum += factor_of(model, load->def) * vec3_length(resultant_of(model, load));
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
