// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape.h"

#include <stddef.h>

#include "contact/ball.h"
#include "contact/halfspace.h"
#include "contact/separation.h"

// A point that moves with the shape, and its velocity.
static Vec3 carry(const ContactShape *shape, double time, Vec3 rest, Vec3 *velocity) {
  if (!shape->move) {
    *velocity = vec3_at(shape->velocity);
    return vec3_add(rest, vec3_scale(time, *velocity));
  }
  double from[3], to[3], speed[3];
  vec3_store(from, rest);
  shape->move(shape->motion, time, from, to, speed);
  *velocity = vec3_at(speed);
  return vec3_at(to);
}

Vec3 contact_shape_point(const ContactShape *shape, double time) {
  Vec3 velocity;
  return carry(shape, time, vec3_at(shape->point), &velocity);
}

// With R e_k and Ṙ e_k of the three axes e_k: ω = ½ Σ R e_k × Ṙ e_k.
Vec3 contact_shape_velocity(const ContactShape *shape, double time, Vec3 x) {
  Vec3 rest = vec3_at(shape->point), velocity, spin = {0, 0, 0};
  Vec3 point = carry(shape, time, rest, &velocity);
  if (!shape->move) return velocity;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; k++) {
    Vec3 speed, end = carry(shape, time, vec3_add(rest, axes[k]), &speed);
    Vec3 turned = vec3_cross(vec3_sub(end, point), vec3_sub(speed, velocity));
    spin = vec3_add(spin, vec3_scale(0.5, turned));
  }
  return vec3_add(velocity, vec3_cross(spin, vec3_sub(x, point)));
}

void contact_shape_overlap(const ContactShape *shape, double time, const double tet[12], double *volume,
                           double gradient[12], double hessian[144]) {
  double point[3];
  vec3_store(point, contact_shape_point(shape, time));
  switch (shape->kind) {
  case CONTACT_SHAPE_HALFSPACE:
    contact_halfspace_overlap(tet, point, shape->normal, volume, gradient, hessian);
    return;
  case CONTACT_SHAPE_BALL:
    contact_ball_overlap(tet, point, shape->radius, volume, gradient, hessian);
    return;
  }
}

double contact_shape_separation(const ContactShape *shape, double time, const double tet[12]) {
  double point[3];
  vec3_store(point, contact_shape_point(shape, time));
  return shape->kind == CONTACT_SHAPE_BALL ? contact_ball_separation(tet, point, shape->radius)
                                           : contact_separation_halfspace(tet, point, shape->normal);
}

static double distance_to_box(Vec3 x, const double *positions, int begin, int end) {
  const double at[3] = {x.x, x.y, x.z};
  double square = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t v = (size_t)begin; v < (size_t)end; v++)
      low = fmin(low, positions[3 * v + (size_t)c]), high = fmax(high, positions[3 * v + (size_t)c]);
    double outside = fmax(fmax(low - at[c], at[c] - high), 0);
    square += outside * outside;
  }
  return sqrt(square);
}

double contact_shape_clearance(const ContactShape *shape, double time, const double *positions, int begin,
                               int end) {
  Vec3 point = contact_shape_point(shape, time), normal = vec3_at(shape->normal);
  if (shape->kind == CONTACT_SHAPE_BALL) return distance_to_box(point, positions, begin, end) - shape->radius;
  double lowest = INFINITY;
  for (size_t v = (size_t)begin; v < (size_t)end; v++)
    lowest = fmin(lowest, vec3_dot(vec3_sub(vec3_at(positions + 3 * v), point), normal));
  return lowest;
}

// What counts of a motion: of a plane the part along its normal.
static double length_of(const ContactShape *shape, Vec3 motion) {
  return shape->kind == CONTACT_SHAPE_BALL ? vec3_length(motion)
                                           : fabs(vec3_dot(motion, vec3_at(shape->normal)));
}

double contact_shape_motion(const ContactShape *shape, double from, double to) {
  return length_of(shape, vec3_sub(contact_shape_point(shape, to), contact_shape_point(shape, from)));
}

double contact_shape_speed(const ContactShape *shape, double time) {
  Vec3 velocity;
  carry(shape, time, vec3_at(shape->point), &velocity);
  return length_of(shape, velocity);
}

Status contact_shape_check(const ContactShape *shape) {
  double length = vec3_length(vec3_at(shape->normal));
  if (shape->kind == CONTACT_SHAPE_HALFSPACE && !(fabs(length - 1) <= 1e-9))
    return status_fail(STATUS_INPUT, "contact: the normal of half-space %s has length %g instead of 1",
                       shape->name, length);
  if (shape->kind == CONTACT_SHAPE_BALL && !(shape->radius > 0 && isfinite(shape->radius)))
    return status_fail(STATUS_INPUT, "contact: the radius of ball %s is %g m; it must be positive",
                       shape->name, shape->radius);
  return STATUS_OK;
}
