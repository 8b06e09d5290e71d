// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/footprint.h"

#include "base/memory.h"

#define HELD(...)                                                                                            \
  memory_held_by(sizeof((const void *[]){__VA_ARGS__}) / sizeof(void *), (const void *const[]){__VA_ARGS__})

size_t contact_footprint_layout(const ContactLayout *layout) {
  const ContactSelf *self = &layout->self;
  const ContactMesh *mesh = &layout->mesh;
  return HELD(layout->rest, layout->cell_volumes, mesh->cell_begin, mesh->own, mesh->tets, mesh->replaced,
              mesh->turns, mesh->outer, mesh->virtuals, mesh->depths, layout->tet_volumes,
              layout->vertex_volumes, layout->interfaces, layout->nudges, layout->shifts, self->outer,
              self->cell_begin, self->is_outer, self->left_out.pairs);
}

static size_t of_list(const ContactCandidateList *list) {
  return HELD(list->pairs, list->begin, list->margins, list->cells);
}

size_t contact_footprint_candidates(const ContactCandidates *candidates) {
  const ContactKeptCandidates *kept = &candidates->kept;
  size_t found = 0;
  for (int f = 0; f < candidates->found_count; f++) found += memory_held(candidates->found[f].pairs.pairs);
  return found + of_list(&candidates->list) + of_list(&kept->list) +
         HELD(kept->positions, kept->shapes, kept->expected, kept->is_left_out) +
         HELD(candidates->reference, candidates->found, candidates->is_listed, candidates->boxes,
              candidates->motions, candidates->expected, candidates->is_left_out);
}

size_t contact_footprint_near(const ContactNear *near) {
  return of_list(&near->list) +
         HELD(near->reference, near->motions, near->blown, near->boxes, near->is_listed, near->is_kept);
}

size_t contact_footprint_rest(const ContactRest *rest) {
  return HELD(rest->is_resting, rest->is_near, rest->forces, rest->covered, rest->interfaces, rest->areas);
}

static size_t of_patches(const ContactPatches *patches) {
  return HELD(patches->patches, patches->elements, patches->nodes, patches->pair_elements,
              patches->element_of_tet, patches->node_of_vertex);
}

size_t contact_footprint_evaluation(const ContactEvaluation *evaluation) {
  return of_patches(&evaluation->patches) +
         HELD(evaluation->positions, evaluation->pairs, evaluation->coordinates, evaluation->volumes,
              evaluation->gradients, evaluation->pair_forces, evaluation->nodes, evaluation->forces,
              evaluation->covered, evaluation->interfaces, evaluation->is_kept, evaluation->boxes,
              evaluation->flags, evaluation->centroids, evaluation->fields);
}

size_t contact_footprint_status(const ContactStatus *status) {
  return HELD(status->predicted, status->exact, status->error, status->wrong_pairs, status->portion,
              status->coordinates, status->asked, status->volumes, status->places, status->says[0],
              status->says[1], status->boxes);
}
