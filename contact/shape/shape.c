// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/shape.h"

#include <stdbool.h>
#include <stddef.h>

#include "contact/limits.h"
#include "contact/shape/ball.h"
#include "contact/shape/convex.h"
#include "contact/shape/cylinder.h"
#include "contact/shape/halfspace.h"
#include "overlap/separation.h"

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

// Where a shape's own frame is.
typedef struct Pose {
  Vec3 point, axes[3]; // orthonormal
} Pose;

static Pose pose_of(const ContactShape *shape, double time) {
  Vec3 rest = vec3_at(shape->point), velocity;
  Pose pose = {.point = carry(shape, time, rest, &velocity)};
  for (int k = 0; k < 3; k++) {
    Vec3 axis = vec3_at(shape->axes[k]);
    pose.axes[k] =
        shape->move ? vec3_sub(carry(shape, time, vec3_add(rest, axis), &velocity), pose.point) : axis;
  }
  return pose;
}

static Vec3 in_frame(const Pose *pose, Vec3 x) {
  Vec3 arm = vec3_sub(x, pose->point);
  return (Vec3){vec3_dot(pose->axes[0], arm), vec3_dot(pose->axes[1], arm), vec3_dot(pose->axes[2], arm)};
}

static void to_own_frame(const Pose *pose, const double tet[12], double own[12]) {
  for (int v = 0; v < 4; v++) {
    Vec3 arm = vec3_sub(vec3_at(tet + 3 * v), pose->point);
    for (int k = 0; k < 3; k++) own[3 * v + k] = vec3_dot(pose->axes[k], arm);
  }
}

// With R e_k and Ṙ e_k of the three axes e_k: ω = ½ Σ R e_k × Ṙ e_k.
static Vec3 spin_of(const ContactShape *shape, double time, Vec3 *point, Vec3 *velocity) {
  Vec3 rest = vec3_at(shape->point), spin = {0, 0, 0};
  *point = carry(shape, time, rest, velocity);
  if (!shape->move) return spin;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; k++) {
    Vec3 speed, end = carry(shape, time, vec3_add(rest, axes[k]), &speed);
    Vec3 turned = vec3_cross(vec3_sub(end, *point), vec3_sub(speed, *velocity));
    spin = vec3_add(spin, vec3_scale(0.5, turned));
  }
  return spin;
}

Vec3 contact_shape_velocity(const ContactShape *shape, double time, Vec3 x) {
  Vec3 point, velocity, spin = spin_of(shape, time, &point, &velocity);
  return vec3_add(velocity, vec3_cross(spin, vec3_sub(x, point)));
}

Vec3 contact_shape_place_before(const ContactShape *shape, double time, double before, Vec3 x) {
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 rest = vec3_at(shape->point), velocity;
  Vec3 now = carry(shape, time, rest, &velocity), place = carry(shape, before, rest, &velocity),
       arm = vec3_sub(x, now);
  if (!shape->move) return vec3_add(place, arm);
  const Vec3 there = place;
  for (int k = 0; k < 3; k++) {
    Vec3 end = vec3_add(rest, axes[k]);
    double along = vec3_dot(vec3_sub(carry(shape, time, end, &velocity), now), arm);
    place = vec3_add(place, vec3_scale(along, vec3_sub(carry(shape, before, end, &velocity), there)));
  }
  return place;
}

static void turn_gradient(const Pose *pose, double gradient[12]) {
  for (int v = 0; v < 4; v++) {
    Vec3 turned = {0, 0, 0};
    for (int k = 0; k < 3; k++) turned = vec3_add(turned, vec3_scale(gradient[3 * v + k], pose->axes[k]));
    vec3_store(gradient + 3 * v, turned);
  }
}

// H ↦ R H Rᵀ, R turning the own frame into space: its rows, then its columns.
static void turn_hessian(const Pose *pose, double hessian[144]) {
  for (int pass = 0; pass < 2; pass++) {
    for (int r = 0; r < 12; r++) turn_gradient(pose, hessian + 12 * r);
    for (int r = 0; r < 12; r++)
      for (int c = 0; c < r; c++) {
        double kept = hessian[12 * r + c];
        hessian[12 * r + c] = hessian[12 * c + r], hessian[12 * c + r] = kept;
      }
  }
}

// Shapes with a frame of their own.
static bool has_frame(const ContactShape *shape) {
  return shape->kind == CONTACT_SHAPE_CONVEX || shape->kind == CONTACT_SHAPE_CYLINDER;
}

static ContactCylinder cylinder_of(const ContactShape *shape) {
  return (ContactCylinder){shape->radius, shape->half_length, shape->round};
}

static void overlap_in_frame(const ContactShape *shape, double time, const double tet[12], double *volume,
                             double gradient[12]) {
  double own[12];
  Pose pose = pose_of(shape, time);
  ContactCylinder cylinder = cylinder_of(shape);
  to_own_frame(&pose, tet, own);
  if (shape->kind == CONTACT_SHAPE_CONVEX)
    contact_convex_overlap(shape->convex, own, volume, gradient);
  else
    contact_cylinder_overlap(&cylinder, own, volume, gradient);
  if (*volume > 0 && gradient) turn_gradient(&pose, gradient);
}

void contact_shape_overlap(const ContactShape *shape, double time, const double tet[12], double *volume,
                           double gradient[12]) {
  double point[3];
  if (has_frame(shape)) {
    overlap_in_frame(shape, time, tet, volume, gradient);
    return;
  }
  vec3_store(point, contact_shape_point(shape, time));
  if (shape->kind == CONTACT_SHAPE_BALL)
    contact_ball_overlap(tet, point, shape->radius, volume, gradient);
  else
    contact_halfspace_overlap(tet, point, shape->normal, volume, gradient);
}

double contact_shape_middle(const ContactShape *shape) {
  double deepest = INFINITY;
  if (shape->kind == CONTACT_SHAPE_BALL) return shape->radius / 2;
  if (shape->kind == CONTACT_SHAPE_CYLINDER)
    return fmin(shape->radius * shape->radius / (2 * shape->round), shape->half_length);
  for (int k = 0; shape->kind == CONTACT_SHAPE_CONVEX && k < shape->convex->plane_count; k++)
    deepest = fmin(deepest, shape->convex->offsets[k]);
  return deepest;
}

double contact_shape_depth(const ContactShape *shape, double time, Vec3 x) {
  double deepest = INFINITY;
  ContactCylinder cylinder = cylinder_of(shape);
  Pose pose = pose_of(shape, time);
  Vec3 arm = vec3_sub(x, pose.point);
  switch (shape->kind) {
  case CONTACT_SHAPE_HALFSPACE:
    return -vec3_dot(vec3_at(shape->normal), arm);
  case CONTACT_SHAPE_BALL:
    return (shape->radius * shape->radius - vec3_dot(arm, arm)) / (2 * shape->radius);
  case CONTACT_SHAPE_CONVEX:
    arm = in_frame(&pose, x);
    for (int k = 0; k < shape->convex->plane_count; k++)
      deepest = fmin(deepest, shape->convex->offsets[k] - vec3_dot(shape->convex->normals[k], arm));
    return deepest;
  case CONTACT_SHAPE_CYLINDER:
    return contact_cylinder_depth(&cylinder, in_frame(&pose, x));
  }
  return deepest;
}

ContactShape contact_shape_shrink(const ContactShape *shape, double depth, struct ContactConvex *solid) {
  ContactShape smaller = *shape;
  switch (shape->kind) {
  case CONTACT_SHAPE_HALFSPACE:
    vec3_store(smaller.point, vec3_sub(vec3_at(shape->point), vec3_scale(depth, vec3_at(shape->normal))));
    break;
  case CONTACT_SHAPE_BALL:
    smaller.radius = sqrt(fmax(shape->radius * (shape->radius - 2 * depth), 0));
    break;
  case CONTACT_SHAPE_CONVEX:
    *solid = *shape->convex;
    for (int k = 0; k < solid->plane_count; k++) solid->offsets[k] -= depth;
    smaller.convex = solid;
    break;
  case CONTACT_SHAPE_CYLINDER:
    smaller.radius = sqrt(fmax(shape->radius * shape->radius - 2 * shape->round * depth, 0));
    smaller.half_length -= depth;
    break;
  }
  return smaller;
}

void contact_shape_press(const ContactShape *shape, double time, const double tet[12], double rest_volume,
                         double *volume, double *energy, double gradient[12], double hessian[144]) {
  double point[3], own[12];
  if (has_frame(shape)) {
    Pose pose = pose_of(shape, time);
    ContactCylinder cylinder = cylinder_of(shape);
    to_own_frame(&pose, tet, own);
    if (shape->kind == CONTACT_SHAPE_CONVEX)
      contact_convex_press(shape->convex, own, rest_volume, volume, energy, gradient, hessian);
    else
      contact_cylinder_press(&cylinder, own, rest_volume, volume, energy, gradient, hessian);
    if (*volume > 0) turn_gradient(&pose, gradient);
    if (*volume > 0 && hessian) turn_hessian(&pose, hessian);
    return;
  }
  vec3_store(point, contact_shape_point(shape, time));
  if (shape->kind == CONTACT_SHAPE_BALL)
    contact_ball_press(tet, point, shape->radius, rest_volume, volume, energy, gradient, hessian);
  else
    contact_halfspace_press(tet, point, shape->normal, rest_volume, volume, energy, gradient, hessian);
}

ContactShape contact_shape_stand(const ContactShape *shape, double time) {
  const Pose pose = pose_of(shape, time);
  ContactShape still = *shape;
  vec3_store(still.point, pose.point);
  for (int k = 0; k < 3; k++) {
    vec3_store(still.axes[k], pose.axes[k]);
    still.velocity[k] = 0;
  }
  still.move = NULL;
  return still;
}

double contact_shape_separation(const ContactShape *shape, double time, const double tet[12], double enough) {
  double point[3], own[12];
  if (has_frame(shape)) {
    Pose pose = pose_of(shape, time);
    ContactCylinder cylinder = cylinder_of(shape);
    to_own_frame(&pose, tet, own);
    return shape->kind == CONTACT_SHAPE_CONVEX ? contact_convex_separation(shape->convex, own, enough)
                                               : contact_cylinder_separation(&cylinder, own);
  }
  vec3_store(point, contact_shape_point(shape, time));
  return shape->kind == CONTACT_SHAPE_BALL ? contact_ball_separation(tet, point, shape->radius)
                                           : overlap_separation_halfspace(tet, point, shape->normal);
}

double contact_shape_gap(const ContactShape *shape, double time, Vec3 x) {
  if (shape->kind == CONTACT_SHAPE_CYLINDER) {
    Pose pose = pose_of(shape, time);
    Vec3 own = in_frame(&pose, x);
    return fmax(hypot(own.x, own.y) - shape->radius, fabs(own.z) - shape->half_length);
  }
  if (shape->kind == CONTACT_SHAPE_CONVEX) {
    Pose pose = pose_of(shape, time);
    Vec3 own = in_frame(&pose, x);
    double farthest = -INFINITY;
    for (int k = 0; k < shape->convex->plane_count; k++)
      farthest = fmax(farthest, vec3_dot(shape->convex->normals[k], own) - shape->convex->offsets[k]);
    return farthest;
  }
  Vec3 arm = vec3_sub(x, contact_shape_point(shape, time));
  return shape->kind == CONTACT_SHAPE_BALL ? vec3_length(arm) - shape->radius
                                           : vec3_dot(vec3_at(shape->normal), arm);
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

static double lowest_above(Vec3 point, Vec3 normal, const double *positions, int begin, int end) {
  double lowest = INFINITY;
  for (size_t v = (size_t)begin; v < (size_t)end; v++)
    lowest = fmin(lowest, vec3_dot(vec3_sub(vec3_at(positions + 3 * v), point), normal));
  return lowest;
}

// The highest above a plane of the solid.
static double highest_above(const ContactShape *shape, double time, const double *positions, int begin,
                            int end) {
  Pose pose = pose_of(shape, time);
  const ContactConvex *convex = shape->convex;
  double highest = distance_to_box(pose.point, positions, begin, end) - convex->reach;
  for (int k = 0; k < convex->plane_count; k++) {
    Vec3 own = convex->normals[k], normal = vec3_scale(own.x, pose.axes[0]);
    normal = vec3_add(normal, vec3_add(vec3_scale(own.y, pose.axes[1]), vec3_scale(own.z, pose.axes[2])));
    highest = fmax(highest, lowest_above(pose.point, normal, positions, begin, end) - convex->offsets[k]);
  }
  return highest;
}

// Above planes that touch a cylinder all round, and above its ends.
static double highest_above_cylinder(const ContactShape *shape, double time, const double *positions,
                                     int begin, int end) {
  enum { DIRECTION_COUNT = 16 };
  Pose pose = pose_of(shape, time);
  double highest =
      distance_to_box(pose.point, positions, begin, end) - hypot(shape->radius, shape->half_length);
  for (int k = 0; k < DIRECTION_COUNT; k++) {
    double angle = 2 * M_PI * k / DIRECTION_COUNT;
    Vec3 normal = vec3_add(vec3_scale(cos(angle), pose.axes[0]), vec3_scale(sin(angle), pose.axes[1]));
    highest = fmax(highest, lowest_above(pose.point, normal, positions, begin, end) - shape->radius);
  }
  for (int side = -1; side < 2; side += 2) {
    double above = lowest_above(pose.point, vec3_scale(side, pose.axes[2]), positions, begin, end);
    highest = fmax(highest, above - shape->half_length);
  }
  return highest;
}

double contact_shape_clearance(const ContactShape *shape, double time, const double *positions, int begin,
                               int end) {
  Vec3 point = contact_shape_point(shape, time);
  switch (shape->kind) {
  case CONTACT_SHAPE_HALFSPACE:
    return lowest_above(point, vec3_at(shape->normal), positions, begin, end);
  case CONTACT_SHAPE_BALL:
    return distance_to_box(point, positions, begin, end) - shape->radius;
  case CONTACT_SHAPE_CONVEX:
    return highest_above(shape, time, positions, begin, end);
  case CONTACT_SHAPE_CYLINDER:
    return highest_above_cylinder(shape, time, positions, begin, end);
  }
  return 0;
}

// What counts of a motion: of a plane the part along its normal.
static double length_of(const ContactShape *shape, Vec3 motion) {
  return shape->kind == CONTACT_SHAPE_HALFSPACE ? fabs(vec3_dot(motion, vec3_at(shape->normal)))
                                                : vec3_length(motion);
}

// A turn by θ moves what lies at the distance r of its axis by 2 r sin ½θ, and ‖ΔR‖ = 2 √2 sin ½θ
// (Frobenius).
static double turned_by(const ContactShape *shape, double from, double to) {
  if (!shape->move || !has_frame(shape)) return 0;
  Pose before = pose_of(shape, from), after = pose_of(shape, to);
  double square = 0;
  if (shape->kind == CONTACT_SHAPE_CYLINDER)
    return hypot(shape->radius, shape->half_length) * vec3_length(vec3_sub(after.axes[2], before.axes[2]));
  for (int k = 0; k < 3; k++) {
    Vec3 change = vec3_sub(after.axes[k], before.axes[k]);
    square += vec3_dot(change, change);
  }
  return shape->convex->reach * sqrt(square / 2);
}

// By the spin; that of a cylinder about its axis moves no surface.
static double turning_speed(const ContactShape *shape, double time, Vec3 spin) {
  if (shape->kind == CONTACT_SHAPE_CONVEX) return shape->convex->reach * vec3_length(spin);
  if (shape->kind != CONTACT_SHAPE_CYLINDER) return 0;
  Vec3 axis = pose_of(shape, time).axes[2];
  return hypot(shape->radius, shape->half_length) * vec3_length(vec3_cross(spin, axis));
}

double contact_shape_motion(const ContactShape *shape, double from, double to) {
  Vec3 way = vec3_sub(contact_shape_point(shape, to), contact_shape_point(shape, from));
  return length_of(shape, way) + turned_by(shape, from, to);
}

double contact_shape_speed(const ContactShape *shape, double time) {
  Vec3 point, velocity, spin = spin_of(shape, time, &point, &velocity);
  return length_of(shape, velocity) + turning_speed(shape, time, spin);
}

static bool is_orthonormal(const double axes[3][3]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j <= i; j++)
      if (!(fabs(vec3_dot(vec3_at(axes[i]), vec3_at(axes[j])) - (i == j)) <= CONTACT_ROUNDING)) return false;
  return vec3_dot(vec3_cross(vec3_at(axes[0]), vec3_at(axes[1])), vec3_at(axes[2])) > 0;
}

Status contact_shape_check(const ContactShape *shape) {
  double length = vec3_length(vec3_at(shape->normal));
  if (shape->kind == CONTACT_SHAPE_HALFSPACE && !(fabs(length - 1) <= CONTACT_ROUNDING))
    return status_fail(STATUS_INPUT, "contact: the normal of half-space %s has length %g instead of 1",
                       shape->name, length);
  if (shape->kind == CONTACT_SHAPE_BALL && !(shape->radius > 0 && isfinite(shape->radius)))
    return status_fail(STATUS_INPUT, "contact: the radius of ball %s is %g m; it must be positive",
                       shape->name, shape->radius);
  if (shape->kind == CONTACT_SHAPE_CONVEX && !(shape->convex && is_orthonormal(shape->axes)))
    return status_fail(STATUS_INPUT,
                       "contact: obstacle %s needs a solid, and three axes at right angles of length 1",
                       shape->name);
  if (shape->kind == CONTACT_SHAPE_CYLINDER &&
      !(shape->radius > 0 && shape->half_length > 0 && shape->round > 0 && is_orthonormal(shape->axes)))
    return status_fail(STATUS_INPUT,
                       "contact: cylinder %s needs a positive radius and length, and three axes at right "
                       "angles of length 1",
                       shape->name);
  return STATUS_OK;
}
