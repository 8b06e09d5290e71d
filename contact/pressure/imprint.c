// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/imprint.h"

#include <math.h>

#include "base/vec3.h"

static void of_field(const ContactImprintSource *source, const ContactPatch *patch,
                     ContactInterface *interface) {
  Vec3 moment = {0, 0, 0};
  double weight = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    const ContactFieldPair *field = &source->fields[k];
    double force = vec3_length(vec3_at(field->force));
    if (!(field->energy > 0)) continue;
    interface->area += contact_field_area(field);
    moment = vec3_add(moment, vec3_scale(force, vec3_at(field->centroid)));
    weight += force;
  }
  vec3_store(interface->centre, vec3_scale(1 / weight, moment));
}

static void of_gradients(const ContactImprintSource *source, const ContactPatch *patch,
                         ContactInterface *interface) {
  Vec3 area = {0, 0, 0}, moment = {0, 0, 0};
  double weight = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++)
    for (int v = 0; v < 4; v++) area = vec3_add(area, vec3_at(source->gradients + 24 * (size_t)k + 3 * v));
  for (int n = patch->node_begin; n < patch->node_end; n++) {
    const ContactNode *node = &source->patches->nodes[n];
    double force = vec3_length(vec3_at(node->force));
    moment = vec3_add(moment, vec3_scale(force, vec3_at(source->positions + 3 * (size_t)node->vertex)));
    weight += force;
  }
  interface->area = vec3_length(area);
  vec3_store(interface->centre, vec3_scale(1 / weight, moment));
}

void contact_imprint_find(const ContactImprintSource *source, const ContactPatch *patch,
                          ContactInterface *interface) {
  interface->area = 0;
  if (source->fields)
    of_field(source, patch, interface);
  else
    of_gradients(source, patch, interface);
}
