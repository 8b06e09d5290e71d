// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/torque.h"

#include <stddef.h>

#include "base/vec3.h"

// The columns of Σ w (|r|² I − r rᵀ), symmetric, and the centroid that r counts from.
typedef struct Inertia {
  Vec3 centre, x, y, z;
} Inertia;

static Vec3 point(const double *positions, int vertex) {
  return vec3_at(positions + 3 * (size_t)vertex);
}

static Inertia inertia_of(int count, const int *vertices, const double *weights, const double *positions) {
  Inertia inertia = {0};
  double weight = 0;
  for (int i = 0; i < count; i++) {
    inertia.centre = vec3_add(inertia.centre, vec3_scale(weights[i], point(positions, vertices[i])));
    weight += weights[i];
  }
  inertia.centre = vec3_scale(1 / weight, inertia.centre);
  for (int i = 0; i < count; i++) {
    Vec3 r = vec3_sub(point(positions, vertices[i]), inertia.centre);
    double w = weights[i], square = w * vec3_dot(r, r);
    inertia.x = vec3_add(vec3_sub(inertia.x, vec3_scale(w * r.x, r)), (Vec3){square, 0, 0});
    inertia.y = vec3_add(vec3_sub(inertia.y, vec3_scale(w * r.y, r)), (Vec3){0, square, 0});
    inertia.z = vec3_add(vec3_sub(inertia.z, vec3_scale(w * r.z, r)), (Vec3){0, 0, square});
  }
  return inertia;
}

static double det_of(const Inertia *inertia) {
  return vec3_dot(inertia->x, vec3_cross(inertia->y, inertia->z));
}

double fem_torque_breadth(int count, const int *vertices, const double *weights, const double *positions) {
  Inertia inertia = inertia_of(count, vertices, weights, positions);
  double mean = (inertia.x.x + inertia.y.y + inertia.z.z) / 3;
  return mean > 0 ? det_of(&inertia) / (mean * mean * mean) : 0;
}

// ω of J ω = T, by Cramer's rule: J is symmetric, and far from singular.
static Vec3 turn_of(const Inertia *inertia, Vec3 moment) {
  Vec3 minors = {vec3_dot(moment, vec3_cross(inertia->y, inertia->z)),
                 vec3_dot(moment, vec3_cross(inertia->z, inertia->x)),
                 vec3_dot(moment, vec3_cross(inertia->x, inertia->y))};
  return vec3_scale(1 / det_of(inertia), minors);
}

void fem_torque_add_force(const double moment[3], int count, const int *vertices, const double *weights,
                          const double *positions, double *force) {
  Inertia inertia = inertia_of(count, vertices, weights, positions);
  Vec3 turn = turn_of(&inertia, vec3_at(moment));
  for (int i = 0; i < count; i++) {
    Vec3 r = vec3_sub(point(positions, vertices[i]), inertia.centre);
    vec3_accumulate(force + 3 * (size_t)vertices[i], vec3_scale(weights[i], vec3_cross(turn, r)));
  }
}
