// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/obstacle.h"

#include "base/vec3.h"
#include "fem/scene/drive.h"

static void move_shape(const void *motion, double time, const double rest[3], double position[3],
                       double velocity[3]) {
  fem_drive_point(motion, time, rest, position, velocity);
}

static void make_box(const FemObstacleDef *def, ContactShape *shape, ContactConvex *solid) {
  double half[3];
  for (int c = 0; c < 3; c++) half[c] = def->size[c] / 2;
  contact_convex_make_box(solid, half);
  fem_mesh_placement_axes(&def->turn, shape->axes);
}

// About the axis any two directions will do.
static void make_cylinder(const FemObstacleDef *def, ContactShape *shape) {
  Vec3 axis = vec3_at(def->axis);
  axis = vec3_scale(1 / vec3_length(axis), axis);
  Vec3 aside = fabs(axis.x) < 0.6 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0};
  Vec3 first = vec3_sub(aside, vec3_scale(vec3_dot(aside, axis), axis));
  first = vec3_scale(1 / vec3_length(first), first);
  shape->kind = CONTACT_SHAPE_CYLINDER;
  shape->half_length = def->length / 2, shape->round = def->radius;
  vec3_store(shape->axes[0], first);
  vec3_store(shape->axes[1], vec3_cross(axis, first));
  vec3_store(shape->axes[2], axis);
}

void fem_obstacle_shape(const FemObstacleDef *def, ContactShape *shape, ContactConvex *solid) {
  *shape = (ContactShape){.name = def->name,
                          .kind = CONTACT_SHAPE_CONVEX,
                          .radius = def->radius,
                          .convex = solid,
                          .motion = &def->motion,
                          .move = fem_drive_is_still(&def->motion) ? NULL : move_shape};
  vec3_store(shape->point, vec3_at(def->point));
  if (def->kind == FEM_OBSTACLE_BOX) make_box(def, shape, solid);
  if (def->kind == FEM_OBSTACLE_CYLINDER) make_cylinder(def, shape);
  if (def->kind == FEM_OBSTACLE_BALL) shape->kind = CONTACT_SHAPE_BALL;
  if (def->kind != FEM_OBSTACLE_HALFSPACE) return;
  Vec3 normal = vec3_at(def->normal);
  shape->kind = CONTACT_SHAPE_HALFSPACE;
  vec3_store(shape->normal, vec3_scale(1 / vec3_length(normal), normal));
}
