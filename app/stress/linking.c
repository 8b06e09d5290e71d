// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/linking.h"

#include <math.h>

#include "base/vec3.h"

static Vec3 normal_of(Vec3 a, Vec3 b) {
  Vec3 n = vec3_cross(a, b);
  double length = vec3_length(n);
  return length > 0 ? vec3_scale(1 / length, n) : (Vec3){0, 0, 0};
}

static double arc(Vec3 a, Vec3 b) {
  return asin(fmax(-1, fmin(1, vec3_dot(a, b))));
}

// The solid angle of directions from which the segments p₁p₂ and p₃p₄ are seen to cross, with its sign.
static double crossing_angle(Vec3 p1, Vec3 p2, Vec3 p3, Vec3 p4) {
  Vec3 r13 = vec3_sub(p3, p1), r14 = vec3_sub(p4, p1), r23 = vec3_sub(p3, p2), r24 = vec3_sub(p4, p2);
  Vec3 n1 = normal_of(r13, r14), n2 = normal_of(r14, r24), n3 = normal_of(r24, r23), n4 = normal_of(r23, r13);
  double angle = arc(n1, n2) + arc(n2, n3) + arc(n3, n4) + arc(n4, n1);
  double side = vec3_dot(vec3_cross(vec3_sub(p4, p3), vec3_sub(p2, p1)), r13);
  return side > 0 ? angle : -angle;
}

double app_stress_linking(const double *a, int a_count, const double *b, int b_count) {
  double sum = 0;
  for (int i = 0; i + 1 < a_count; i++)
    for (int j = 0; j + 1 < b_count; j++)
      sum += crossing_angle(vec3_at(a + 3 * i), vec3_at(a + 3 * i + 3), vec3_at(b + 3 * j),
                            vec3_at(b + 3 * j + 3));
  return sum / (16 * atan(1));
}
