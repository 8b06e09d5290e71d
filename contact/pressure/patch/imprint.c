// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/patch/imprint.h"

#include <math.h>

#include "base/vec3.h"

void contact_imprint_find(const ContactFieldPair *fields, const ContactPatch *patch,
                          ContactInterface *interface) {
  interface->pressed = 0;
  Vec3 moment = {0, 0, 0};
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    const ContactFieldPair *field = &fields[k];
    double force = vec3_length(vec3_at(field->force));
    if (!(force > 0)) continue;
    moment = vec3_add(moment, vec3_scale(force, vec3_at(field->centroid)));
    interface->pressed += force;
  }
  vec3_store(interface->centre, vec3_scale(1 / interface->pressed, moment));
}
