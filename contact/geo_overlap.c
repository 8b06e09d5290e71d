// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_overlap.h"

#include <limits.h>
#include <stddef.h>

#include "base/memory.h"
#include "contact/weights.h"

static Status load(ContactGeoOverlap *overlap, const char *path) {
  if (!path) return contact_geo_model_create(&overlap->model, NULL);
  TRY(contact_geo_net_create(&overlap->net, path));
  ContactGeoNetwork network = contact_geo_net_interface(overlap->net);
  Status status = contact_geo_model_create(&overlap->model, &network);
  return status == STATUS_OK ? STATUS_OK : status_prefix(status, "%s", path);
}

Status contact_geo_overlap_create(void **self, const char *path) {
  ContactGeoOverlap *overlap = memory_zeroed(1, sizeof *overlap);
  if (!overlap) return status_no_memory("an overlap model");
  Status status = load(overlap, path);
  if (status != STATUS_OK) {
    contact_geo_overlap_destroy(overlap);
    return status;
  }
  *self = overlap;
  return STATUS_OK;
}

void contact_geo_overlap_destroy(void *self) {
  ContactGeoOverlap *overlap = self;
  if (!overlap) return;
  contact_geo_net_destroy(overlap->net);
  memory_free(overlap);
}

Status contact_geo_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags) {
  ContactOverlapBatch batch = {.pair_count = 1,
                               .pairs = pair,
                               .volume = volume,
                               .gradient = gradient,
                               .hessian = hessian,
                               .flags = flags};
  const ContactGeoOverlap *overlap = self;
  return contact_geo_eval(&overlap->model, &batch);
}

// What one thread takes at a time; the cut does not depend on the number of threads.
enum { PORTION = CONTACT_GEO_BUNDLE };

Status contact_geo_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch) {
  const ContactGeoModel *model = &((const ContactGeoOverlap *)self)->model;
  int count = (batch->pair_count + PORTION - 1) / PORTION, first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (count > 1)
  for (int p = 0; p < count; p++) {
    ContactOverlapBatch portion = contact_overlap_part(batch, p * PORTION, PORTION);
    if (contact_geo_eval(model, &portion) != STATUS_OK && p < first_failed) first_failed = p;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  ContactOverlapBatch portion = contact_overlap_part(batch, first_failed * PORTION, PORTION);
  Status status = contact_geo_eval(model, &portion);
  if (status == STATUS_OK)
    return status_fail(STATUS_SOLVER, "pairs %d to %d failed once and not again", first_failed * PORTION,
                       first_failed * PORTION + portion.pair_count - 1);
  return status_prefix(status, "pairs %d to %d", first_failed * PORTION,
                       first_failed * PORTION + portion.pair_count - 1);
}

// `weights`: a file, or the name of one that ships; NULL: `own`.
static Status create_named(void **self, const char *own, const char *weights) {
  char path[4096];
  if (!weights) weights = own;
  if (contact_weights_is_path(weights)) return contact_geo_overlap_create(self, weights);
  TRY(contact_weights_find(weights, path, sizeof path));
  return contact_geo_overlap_create(self, path);
}

static Status create_geo(void **self, const char *weights, const ContactNetOptions *options) {
  (void)options;
  return create_named(self, "geo", weights);
}

static Status create_geo_small(void **self, const char *weights, const ContactNetOptions *options) {
  (void)options;
  return create_named(self, "geo-small", weights);
}

const ContactOverlapOps contact_overlap_geo = {
    .name = "geo",
    .help = "learned: analytic-centre frame and 100 symmetric features; smooth, no ghost forces",
    .has_hessian = true,
    .seconds_per_pair = 1.8e-6,
    .create = create_geo,
    .eval_pair = contact_geo_overlap_eval_pair,
    .eval_batch = contact_geo_overlap_eval_batch,
    .destroy = contact_geo_overlap_destroy,
};

const ContactOverlapOps contact_overlap_geo_small = {
    .name = "geo-small",
    .help = "learned: as geo, with 36 features and a smaller network",
    .has_hessian = true,
    .seconds_per_pair = 6e-7,
    .create = create_geo_small,
    .eval_pair = contact_geo_overlap_eval_pair,
    .eval_batch = contact_geo_overlap_eval_batch,
    .destroy = contact_geo_overlap_destroy,
};
