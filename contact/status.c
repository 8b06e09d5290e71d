// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/status.h"

#include <string.h>

#include "base/memory.h"
#include "contact/search/bounds.h"
#include "overlap/separation.h"

// Pairs that are evaluated at a time.
enum { PORTION_SIZE = 2048 };

// As they were given.
static int count_tets(const ContactLayout *layout) {
  return layout->def.origin ? layout->def.origin_count : layout->def.tet_count;
}

Status contact_status_create(ContactStatus *status, const ContactLayout *layout) {
  *status = (ContactStatus){0};
  size_t tets = (size_t)count_tets(layout);
  status->predicted = memory_zeroed(tets, sizeof *status->predicted);
  status->exact = memory_zeroed(tets, sizeof *status->exact);
  status->error = memory_zeroed(tets, sizeof *status->error);
  status->wrong_pairs = memory_zeroed(tets, sizeof *status->wrong_pairs);
  status->portion = memory_zeroed(PORTION_SIZE, sizeof *status->portion);
  status->coordinates = memory_zeroed(PORTION_SIZE, OVERLAP_PAIR_SIZE * sizeof *status->coordinates);
  status->asked = memory_zeroed(PORTION_SIZE, OVERLAP_PAIR_SIZE * sizeof *status->asked);
  status->volumes = memory_zeroed(PORTION_SIZE, sizeof *status->volumes);
  status->places = memory_zeroed(PORTION_SIZE, sizeof *status->places);
  for (int k = 0; k < 2; k++) status->says[k] = memory_zeroed(PORTION_SIZE, 1);
  status->boxes = memory_zeroed((size_t)layout->mesh.cell_count, sizeof *status->boxes);
  if (status->predicted && status->exact && status->error && status->wrong_pairs && status->portion &&
      status->coordinates && status->asked && status->volumes && status->places && status->says[0] &&
      status->says[1] && status->boxes)
    return STATUS_OK;
  contact_status_destroy(status);
  return status_no_memory("the status of elements");
}

void contact_status_destroy(ContactStatus *status) {
  memory_free(status->predicted);
  memory_free(status->exact);
  memory_free(status->error);
  memory_free(status->wrong_pairs);
  memory_free(status->portion);
  memory_free(status->coordinates);
  memory_free(status->asked);
  memory_free(status->volumes);
  memory_free(status->places);
  for (int k = 0; k < 2; k++) memory_free(status->says[k]);
  memory_free(status->boxes);
  *status = (ContactStatus){0};
}

// The pairs of the portion that a model evaluates: all where it may give a volume to disjoint pairs, else
// those that no face separates.
static int choose(ContactStatus *status, const OverlapModel *model, int count) {
  bool sees_ghosts = overlap_model_has_ghosts(model);
  int chosen = 0;
  for (int k = 0; k < count; k++) {
    const double *pair = status->coordinates + OVERLAP_PAIR_SIZE * (size_t)k;
    if (!sees_ghosts && overlap_separation_is_certain(pair)) continue;
    memcpy(status->asked + OVERLAP_PAIR_SIZE * (size_t)chosen, pair, OVERLAP_PAIR_SIZE * sizeof *pair);
    status->places[chosen++] = k;
  }
  return chosen;
}

// What a model says of the portion's pairs.
static Status find_verdicts(ContactStatus *status, const OverlapModel *model, int count,
                            unsigned char *says) {
  int chosen = choose(status, model, count);
  OverlapBatch batch = {.pair_count = chosen, .pairs = status->asked, .volume = status->volumes};
  for (int k = 0; k < count; k++) says[k] = 0;
  TRY(overlap_model_eval(model, &batch));
  for (int k = 0; k < chosen; k++) says[status->places[k]] = status->volumes[k] > 0;
  if (!model->ops->eval_logits) return STATUS_OK;
  bool sees_ghosts = overlap_model_has_ghosts(model);
  TRY(model->ops->eval_logits(model->self, chosen, status->asked, status->volumes));
  for (int k = 0; k < chosen; k++) {
    unsigned char *one = &says[status->places[k]];
    *one = status->volumes[k] > 0 && (*one || sees_ghosts);
  }
  return STATUS_OK;
}

static void compare_verdicts(ContactStatus *status, const ContactLayout *layout, int count) {
  ContactStatusCounts *pairs = &status->pairs;
  for (int k = 0; k < count; k++) {
    bool predicted = status->says[0][k], exact = status->says[1][k];
    pairs->asked++;
    pairs->overlapping += exact;
    pairs->false_positives += predicted && !exact;
    pairs->false_negatives += exact && !predicted;
    for (int side = 0; side < 2; side++) {
      int tet = contact_layout_origin(layout, status->portion[k].cells[side]);
      status->predicted[tet] |= predicted;
      status->exact[tet] |= exact;
      status->wrong_pairs[tet] += predicted != exact;
      status->error[tet] = -1; // was asked; judged when all pairs are known
    }
  }
}

static Status ask_both(ContactStatus *status, const ContactLayout *layout, const OverlapModel *model,
                       const OverlapModel *reference, int count) {
  if (count == 0) return STATUS_OK;
  TRY(find_verdicts(status, model, count, status->says[0]));
  TRY(find_verdicts(status, reference, count, status->says[1]));
  compare_verdicts(status, layout, count);
  return STATUS_OK;
}

static void judge_elements(ContactStatus *status, int tet_count) {
  ContactStatusCounts *elements = &status->elements;
  for (int e = 0; e < tet_count; e++) {
    bool was_asked = status->error[e] < 0, predicted = status->predicted[e], exact = status->exact[e];
    status->error[e] = predicted == exact ? CONTACT_VERDICT_RIGHT
                       : predicted        ? CONTACT_VERDICT_FALSE_POSITIVE
                                          : CONTACT_VERDICT_FALSE_NEGATIVE;
    elements->asked += was_asked;
    elements->overlapping += exact;
    elements->false_positives += predicted && !exact;
    elements->false_negatives += exact && !predicted;
  }
}

static void clear(ContactStatus *status, int tet_count) {
  size_t bytes = (size_t)tet_count * sizeof(int);
  memset(status->predicted, 0, bytes);
  memset(status->exact, 0, bytes);
  memset(status->error, 0, bytes);
  memset(status->wrong_pairs, 0, bytes);
  status->pairs = status->elements = (ContactStatusCounts){0};
}

Status contact_status_run(ContactStatus *status, const ContactLayout *layout,
                          const ContactCandidateList *candidates, const OverlapModel *model,
                          const OverlapModel *reference, const double *positions) {
  int count = 0, tet_count = count_tets(layout);
  double apart = 3 * layout->nudge;
  clear(status, tet_count);
  contact_candidates_bound(candidates, layout, positions, status->boxes);
  for (int k = 0; k < candidates->count; k++) {
    const ContactPair *pair = &candidates->pairs[k];
    if (pair->cells[1] < 0) continue;
    if (contact_bounds_distance(status->boxes[pair->cells[0]], status->boxes[pair->cells[1]]) > apart)
      continue;
    status->portion[count] = *pair;
    contact_layout_gather_pair(layout, pair, positions,
                               status->coordinates + OVERLAP_PAIR_SIZE * (size_t)count);
    if (++count < PORTION_SIZE) continue;
    TRY(ask_both(status, layout, model, reference, count));
    count = 0;
  }
  TRY(ask_both(status, layout, model, reference, count));
  judge_elements(status, tet_count);
  return STATUS_OK;
}
