// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_overlap.h"

#include <limits.h>
#include <stddef.h>

Status contact_geo_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags) {
  ContactOverlapBatch batch = {.pair_count = 1,
                               .pairs = pair,
                               .volume = volume,
                               .gradient = gradient,
                               .hessian = hessian,
                               .flags = flags};
  return contact_geo_eval(self, &batch);
}

// What one thread takes at a time; the cut does not depend on the number of threads.
enum { PORTION = 4 * CONTACT_GEO_CHUNK };

static ContactOverlapBatch portion_of(const ContactOverlapBatch *batch, int number) {
  int first = number * PORTION, left = batch->pair_count - first;
  size_t begin = (size_t)first * CONTACT_PAIR_SIZE;
  return (ContactOverlapBatch){.pair_count = left < PORTION ? left : PORTION,
                               .pairs = batch->pairs + begin,
                               .volume = batch->volume + first,
                               .gradient = batch->gradient ? batch->gradient + begin : NULL,
                               .hessian = batch->hessian ? batch->hessian + begin * CONTACT_PAIR_SIZE : NULL,
                               .flags = batch->flags ? batch->flags + first : NULL};
}

Status contact_geo_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch) {
  int count = (batch->pair_count + PORTION - 1) / PORTION, first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (count > 1)
  for (int p = 0; p < count; p++) {
    ContactOverlapBatch portion = portion_of(batch, p);
    if (contact_geo_eval(self, &portion) != STATUS_OK && p < first_failed) first_failed = p;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  ContactOverlapBatch portion = portion_of(batch, first_failed);
  Status status = contact_geo_eval(self, &portion);
  if (status == STATUS_OK)
    return status_fail(STATUS_SOLVER, "pairs %d to %d failed once and not again", first_failed * PORTION,
                       first_failed * PORTION + portion.pair_count - 1);
  return status_prefix(status, "pairs %d to %d", first_failed * PORTION,
                       first_failed * PORTION + portion.pair_count - 1);
}
