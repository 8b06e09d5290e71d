// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/triangle.h"

#include <math.h>
#include <stdbool.h>

double contact_triangle_square_of_edge(Vec3 a, Vec3 b) {
  Vec3 edge = vec3_sub(b, a);
  double square = vec3_dot(edge, edge), share = square > 0 ? -vec3_dot(a, edge) / square : 0;
  Vec3 nearest = vec3_add(a, vec3_scale(fmin(fmax(share, 0), 1), edge));
  return vec3_dot(nearest, nearest);
}

double contact_triangle_square(const Vec3 corners[3]) {
  Vec3 normal = vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
  bool is_inside = vec3_dot(normal, normal) > 0;
  double nearest = INFINITY;
  for (int v = 0; v < 3; v++) {
    Vec3 a = corners[v], b = corners[(v + 1) % 3];
    is_inside = is_inside && vec3_dot(vec3_cross(normal, vec3_sub(b, a)), a) <= 0;
    nearest = fmin(nearest, contact_triangle_square_of_edge(a, b));
  }
  if (!is_inside) return nearest;
  double height = vec3_dot(normal, corners[0]);
  return height * height / vec3_dot(normal, normal);
}
