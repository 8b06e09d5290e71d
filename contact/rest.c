// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/rest.h"

#include <string.h>

#include "base/memory.h"

Status contact_rest_create(ContactRest *rest, const ContactLayout *layout) {
  size_t interfaces = (size_t)layout->interface_count;
  *rest = (ContactRest){0};
  rest->is_resting = memory_zeroed(interfaces, sizeof *rest->is_resting);
  rest->is_near = memory_zeroed(interfaces, sizeof *rest->is_near);
  rest->forces = memory_zeroed(3 * (size_t)layout->def.vertex_count, sizeof(double));
  rest->covered = memory_zeroed((size_t)layout->def.tet_count, sizeof(double));
  rest->interfaces = memory_zeroed(interfaces, sizeof *rest->interfaces);
  rest->areas = memory_zeroed(interfaces, sizeof *rest->areas);
  bool fits =
      rest->is_resting && rest->is_near && rest->forces && rest->covered && rest->interfaces && rest->areas;
  return fits ? STATUS_OK : status_no_memory("contact at rest");
}

void contact_rest_destroy(ContactRest *rest) {
  memory_free(rest->is_resting);
  memory_free(rest->is_near);
  memory_free(rest->forces);
  memory_free(rest->covered);
  memory_free(rest->interfaces);
  memory_free(rest->areas);
  *rest = (ContactRest){0};
}

void contact_rest_clear(ContactRest *rest, const ContactLayout *layout) {
  memset(rest->is_resting, 0, (size_t)layout->interface_count * sizeof *rest->is_resting);
  memset(rest->is_near, 0, (size_t)layout->interface_count * sizeof *rest->is_near);
  memset(rest->areas, 0, (size_t)layout->interface_count * sizeof *rest->areas);
  memset(rest->forces, 0, 3 * (size_t)layout->def.vertex_count * sizeof(double));
  memset(rest->covered, 0, (size_t)layout->def.tet_count * sizeof(double));
  rest->resting_count = 0;
  rest->candidate_count = rest->pair_count = 0;
  rest->energy = 0;
}

static void keep_patch(ContactRest *rest, const ContactPatches *patches, const ContactPatch *patch) {
  for (int n = patch->node_begin; n < patch->node_end; n++)
    for (size_t c = 0; c < 3; c++)
      rest->forces[3 * (size_t)patches->nodes[n].vertex + c] += patches->nodes[n].force[c];
  for (int e = patch->element_begin; e < patch->element_end; e++)
    rest->covered[patches->elements[e].tet] += patches->elements[e].covered;
  rest->energy += patch->energy;
  rest->pair_count += patch->pair_end - patch->pair_begin;
}

void contact_rest_keep(ContactRest *rest, const ContactLayout *layout, const ContactCandidateList *candidates,
                       const ContactPatches *patches, const ContactInterface *interfaces,
                       const bool *is_held) {
  contact_rest_clear(rest, layout);
  for (int f = 0; f < layout->interface_count; f++) {
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    int pairs = candidates->begin[f + 1] - candidates->begin[f];
    rest->is_resting[f] = is_held[interface->a] && is_held[interface->b];
    if (!rest->is_resting[f]) continue;
    rest->resting_count++;
    rest->is_near[f] = pairs > 0;
    rest->candidate_count += pairs;
    rest->interfaces[f] = interfaces[f];
  }
  for (int p = 0; p < patches->patch_count; p++)
    if (rest->is_resting[patches->patches[p].interface]) keep_patch(rest, patches, &patches->patches[p]);
}
