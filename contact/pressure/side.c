// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/side.h"

#include <math.h>

ContactSide contact_side_of(const ContactLayout *layout, int cell, const double coordinates[12]) {
  ContactSide side;
  for (int v = 0; v < 4; v++) side.x[v] = vec3_at(coordinates + 3 * v);
  Vec3 a = vec3_sub(side.x[1], side.x[0]), b = vec3_sub(side.x[2], side.x[0]),
       c = vec3_sub(side.x[3], side.x[0]);
  Vec3 bc = vec3_cross(b, c);
  double det = vec3_dot(a, bc), inverse = 1 / det;
  side.slope[1] = vec3_scale(inverse, bc);
  side.slope[2] = vec3_scale(inverse, vec3_cross(c, a));
  side.slope[3] = vec3_scale(inverse, vec3_cross(a, b));
  side.slope[0] = vec3_scale(-1, vec3_add(side.slope[1], vec3_add(side.slope[2], side.slope[3])));
  side.sign = layout->mesh.turns[cell] * det < 0 ? -1 : 1;
  side.g = (Vec3){0, 0, 0};
  for (int v = 0; v < 4; v++) {
    side.depths[v] = side.sign * layout->mesh.depths[layout->mesh.cells[cell][v]];
    side.g = vec3_add(side.g, vec3_scale(side.depths[v], side.slope[v]));
  }
  side.s = 6 * layout->cell_volumes[cell] * fabs(inverse);
  return side;
}

void contact_side_locate(const ContactSide *side, Vec3 x, double lambda[4]) {
  Vec3 arm = vec3_sub(x, side->x[0]);
  for (int v = 1; v < 4; v++) lambda[v] = vec3_dot(side->slope[v], arm);
  lambda[0] = 1 - lambda[1] - lambda[2] - lambda[3];
}
