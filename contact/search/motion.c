// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/motion.h"

#include <math.h>

#include "contact/shape/shape.h"

ContactMotion contact_motion_of(const double *to, const double *from, int begin, int end) {
  ContactMotion motion = {.mean = {0, 0, 0}};
  double share = 1.0 / (end - begin), spread = 0, longest = 0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t v = (size_t)begin; v < (size_t)end; v++) {
      Vec3 d = from ? vec3_sub(vec3_at(to + 3 * v), vec3_at(from + 3 * v)) : vec3_at(to + 3 * v);
      if (pass == 0) {
        motion.mean = vec3_add(motion.mean, vec3_scale(share, d));
        continue;
      }
      Vec3 rest = vec3_sub(d, motion.mean);
      double square = vec3_dot(d, d), apart = vec3_dot(rest, rest);
      if (!(square <= longest)) longest = isnan(square) ? INFINITY : square;
      if (!(apart <= spread)) spread = isnan(apart) ? INFINITY : apart;
    }
  motion.longest = sqrt(longest);
  motion.spread = sqrt(spread);
  return motion;
}

ContactMotion contact_motion_of_shape(double way) {
  return (ContactMotion){.mean = {0, 0, 0}, .spread = way, .longest = way};
}

void contact_motion_measure(const ContactLayout *layout, double reference_time, const double *reference,
                            double time, const double *positions, ContactMotion *motions) {
  const ContactSystemDef *def = &layout->def;
#pragma omp parallel for schedule(static) if (def->vertex_count > 8192)
  for (int b = 0; b < def->body_count; b++)
    motions[b] =
        contact_motion_of(positions, reference, def->bodies[b].vertex_begin, def->bodies[b].vertex_end);
  for (int h = 0; h < def->shape_count; h++)
    motions[def->body_count + h] =
        contact_motion_of_shape(contact_shape_motion(&def->shapes[h], reference_time, time));
}

double contact_motion_approach(const ContactMotion *motions, const ContactInterfaceDef *interface) {
  const ContactMotion *a = &motions[interface->a], *b = &motions[interface->b];
  if (interface->a == interface->b) return 2 * a->spread;
  double apart = vec3_length(vec3_sub(a->mean, b->mean));
  return fmin(a->longest + b->longest, a->spread + b->spread + apart);
}
