// SPDX-License-Identifier: Apache-2.0
// 3-vectors as small values; double[3] stays the form in arrays.
#ifndef TETLAP_BASE_VEC3_H
#define TETLAP_BASE_VEC3_H

#include <math.h>

typedef struct Vec3 {
  double x, y, z;
} Vec3;

static inline Vec3 vec3_at(const double *p) {
  return (Vec3){p[0], p[1], p[2]};
}
static inline void vec3_store(double *p, Vec3 a) {
  p[0] = a.x, p[1] = a.y, p[2] = a.z;
}
static inline void vec3_accumulate(double *p, Vec3 a) {
  p[0] += a.x, p[1] += a.y, p[2] += a.z;
}
static inline Vec3 vec3_add(Vec3 a, Vec3 b) {
  return (Vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline Vec3 vec3_sub(Vec3 a, Vec3 b) {
  return (Vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline Vec3 vec3_scale(double s, Vec3 a) {
  return (Vec3){s * a.x, s * a.y, s * a.z};
}
static inline double vec3_dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline Vec3 vec3_cross(Vec3 a, Vec3 b) {
  return (Vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double vec3_length(Vec3 a) {
  return sqrt(vec3_dot(a, a));
}

// Six times the signed volume of the tetrahedron a b c d; positive if d sees a b c counter-clockwise from
// within, that is (b − a) · ((c − a) × (d − a)).
static inline double vec3_det4(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return vec3_dot(vec3_sub(b, a), vec3_cross(vec3_sub(c, a), vec3_sub(d, a)));
}

#endif
