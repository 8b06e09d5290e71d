// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/obstacle.h"

#include <float.h>
#include <math.h>

#include "base/vec3.h"
#include "fem/scene/drive.h"

// What rounding may leave: of a box's surface, over an element's edge h; of the part of an element within a
// cylinder, (R/h)² times rounding; of its energy within a ball, (R/h)³ times that of long double (ball.h).
static const double BOX_ERROR = 1e-6, CYLINDER_ERROR = 1e-6, BALL_ERROR = 1e-10;

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

static Status check_size(double size, double most) {
  if (!(size > most)) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "is %.3g m large, and beside the elements rounding leaves it no surface; take %.0e m at "
                     "most, or a halfspace",
                     size, pow(10, floor(log10(most))));
}

Status fem_obstacle_check(const FemObstacleDef *def, double edge) {
  const double longest = BOX_ERROR / DBL_EPSILON * edge, widest = sqrt(CYLINDER_ERROR / DBL_EPSILON) * edge,
               roundest = cbrt(BALL_ERROR / (double)LDBL_EPSILON) * edge;
  for (int c = 0; c < 3 && def->kind == FEM_OBSTACLE_BOX; c++) TRY(check_size(def->size[c], longest));
  if (def->kind == FEM_OBSTACLE_CYLINDER) TRY(check_size(def->length, longest));
  if (def->kind == FEM_OBSTACLE_CYLINDER) TRY(check_size(def->radius, widest));
  return def->kind == FEM_OBSTACLE_BALL ? check_size(def->radius, roundest) : STATUS_OK;
}
