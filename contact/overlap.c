// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/overlap.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "contact/clip.h"
#include "contact/exact.h"
#include "contact/geo_overlap.h"
#include "contact/net_overlap.h"
#include "contact/overlap_cgal.h"
#include "contact/separation.h"
#include "contact/weights.h"

// The fastest first: what a person reads when asking for the models.
static const ContactOverlapOps *const models[] = {
    &contact_overlap_clip,      &contact_overlap_clip32,    &contact_overlap_clip_scalar,
    &contact_overlap_geo_small, &contact_overlap_geo,       &contact_overlap_tpn,
    &contact_overlap_tpn_bf16,  &contact_overlap_tpn_scene, &contact_overlap_hybrid,
    &contact_overlap_exact,     &contact_overlap_cgal,
};
enum { MODEL_COUNT = sizeof models / sizeof *models };

const ContactOverlapOps *const *contact_overlap_list(int *count) {
  *count = MODEL_COUNT;
  return models;
}

static Status fail_unknown(const char *name) {
  char known[256] = "";
  size_t used = 0;
  TextGuess guess = text_guess_of(name);
  for (int m = 0; m < MODEL_COUNT; m++) {
    text_append(known, sizeof known, &used, "%s%s", m ? ", " : "", models[m]->name);
    text_guess_offer(&guess, models[m]->name);
  }
  if (guess.best)
    return status_fail(STATUS_INPUT, "there is no overlap model '%s': did you mean '%s'? Known are %s", name,
                       guess.best, known);
  return status_fail(STATUS_INPUT, "there is no overlap model '%s': known are %s", name, known);
}

// The model that a weights file holds.
static Status find_by_file(const char *path, const ContactOverlapOps **ops) {
  ContactWeightsKind kind;
  TRY(contact_weights_kind(path, &kind));
  *ops = kind == CONTACT_WEIGHTS_TPN ? &contact_overlap_tpn : &contact_overlap_geo;
  return STATUS_OK;
}

Status contact_overlap_create_with(ContactOverlapModel *model, const char *name, const char *weights,
                                   const ContactNetOptions *options) {
  *model = (ContactOverlapModel){0};
  const ContactOverlapOps *ops = NULL;
  for (int m = 0; m < MODEL_COUNT; m++)
    if (strcmp(models[m]->name, name) == 0) ops = models[m];
  if (!ops && contact_weights_is_path(name)) {
    TRY(find_by_file(name, &ops));
    weights = name;
  }
  if (!ops) return fail_unknown(name);
  if (ops->create) TRY(ops->create(&model->self, weights, options));
  model->ops = ops;
  return STATUS_OK;
}

Status contact_overlap_create(ContactOverlapModel *model, const char *name) {
  return contact_overlap_create_with(model, name, NULL, NULL);
}

bool contact_overlap_has_ghosts(const ContactOverlapModel *model) {
  return model->ops->has_ghosts && model->ops->has_ghosts(model->self);
}

bool contact_overlap_has_hessian(const ContactOverlapModel *model) {
  return model->ops->bends ? model->ops->bends(model->self) : model->ops->has_hessian;
}

void contact_overlap_destroy(ContactOverlapModel *model) {
  if (model->ops && model->ops->destroy) model->ops->destroy(model->self);
  *model = (ContactOverlapModel){0};
}

ContactOverlapBatch contact_overlap_part(const ContactOverlapBatch *batch, int begin, int count) {
  enum { SIZE = CONTACT_PAIR_SIZE };
  size_t at = (size_t)begin * SIZE;
  int left = batch->pair_count - begin;
  return (ContactOverlapBatch){.pair_count = left < count ? left : count,
                               .pairs = batch->pairs + at,
                               .volume = batch->volume + begin,
                               .gradient = batch->gradient ? batch->gradient + at : NULL,
                               .hessian = batch->hessian ? batch->hessian + at * SIZE : NULL,
                               .flags = batch->flags ? batch->flags + begin : NULL};
}

void contact_overlap_swap(const double pair[24], double swapped[24]) {
  enum { HALF = CONTACT_PAIR_SIZE / 2 };
  memcpy(swapped, pair + HALF, HALF * sizeof *pair);
  memcpy(swapped + HALF, pair, HALF * sizeof *pair);
}

// x − x is 0 for finite x, else NaN. Eight sums that a compiler keeps side by side.
static inline bool is_finite(const double pair[CONTACT_PAIR_SIZE]) {
  double sum[8] = {0};
  for (int i = 0; i < CONTACT_PAIR_SIZE; i++) sum[i % 8] += pair[i] - pair[i];
  for (int i = 0; i < 4; i++) sum[i] += sum[i + 4];
  return sum[0] + sum[1] + sum[2] + sum[3] == 0;
}

static Status fail_not_finite(int pair_index, const double pair[CONTACT_PAIR_SIZE]) {
  int i = 0;
  while (isfinite(pair[i])) i++;
  return status_fail(STATUS_INPUT,
                     "pair %d, tetrahedron %d, vertex %d: coordinate %c is %g, it must be a finite number",
                     pair_index, i / 12, i / 3 % 4, "xyz"[i % 3], pair[i]);
}

// The first pair with a coordinate that is not finite, pair_count if there is none.
static int first_not_finite(const ContactOverlapBatch *batch) {
  int first = batch->pair_count;
#pragma omp parallel for schedule(static) reduction(min : first) if (batch->pair_count > 20000)
  for (int i = 0; i < batch->pair_count; i++)
    if (!is_finite(batch->pairs + (size_t)i * CONTACT_PAIR_SIZE) && i < first) first = i;
  return first;
}

static Status check_finite(const ContactOverlapBatch *batch) {
  int bad = first_not_finite(batch);
  return bad == batch->pair_count ? STATUS_OK
                                  : fail_not_finite(bad, batch->pairs + (size_t)bad * CONTACT_PAIR_SIZE);
}

static Status eval_one(const ContactOverlapModel *model, const ContactOverlapBatch *batch, int i) {
  const double *pair = batch->pairs + (size_t)i * CONTACT_PAIR_SIZE;
  double *gradient = batch->gradient ? batch->gradient + (size_t)i * CONTACT_PAIR_SIZE : NULL;
  double *hessian =
      batch->hessian ? batch->hessian + (size_t)i * CONTACT_PAIR_SIZE * CONTACT_PAIR_SIZE : NULL;
  unsigned flags = 0;
  Status status = model->ops->eval_pair(model->self, pair, batch->volume + i, gradient, hessian, &flags);
  if (batch->flags) batch->flags[i] = flags;
  return status;
}

static void write_disjoint(const ContactOverlapBatch *batch, int i) {
  enum { SIZE = CONTACT_PAIR_SIZE };
  batch->volume[i] = 0;
  if (batch->gradient) memset(batch->gradient + (size_t)i * SIZE, 0, SIZE * sizeof(double));
  if (batch->hessian) memset(batch->hessian + (size_t)i * SIZE * SIZE, 0, SIZE * SIZE * sizeof(double));
  if (batch->flags) batch->flags[i] = CONTACT_OVERLAP_DISJOINT;
}

// Less work than this [s] is not worth waking threads for.
static const double WORTH_THREADS = 2e-4;

enum { PORTION = 64 }; // pairs that a thread takes at a time

// Pairs begin … end, but for those that a face separates: what these are is known without the model. The
// first that failed, or INT_MAX.
static int eval_portion(const ContactOverlapModel *model, const ContactOverlapBatch *batch, int begin,
                        int end) {
  bool is_apart[PORTION] = {false};
  if (!model->ops->rejects && !contact_overlap_has_ghosts(model))
    contact_separation_find(end - begin, batch->pairs + (size_t)begin * CONTACT_PAIR_SIZE, is_apart);
  for (int i = begin; i < end; i++)
    if (is_apart[i - begin])
      write_disjoint(batch, i);
    else if (eval_one(model, batch, i) != STATUS_OK)
      return i;
  return INT_MAX;
}

// Each pair has its own place in the outputs, so the threads' order does not show. Costs differ from pair to
// pair by a hundred and more: portions are handed out as threads get free.
static Status eval_each(const ContactOverlapModel *model, const ContactOverlapBatch *batch) {
  int first_failed = INT_MAX, count = batch->pair_count, portions = count / PORTION + (count % PORTION > 0);
  bool is_much = count * model->ops->seconds_per_pair > WORTH_THREADS;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (is_much)
  for (int p = 0; p < portions; p++) {
    int begin = p * PORTION, end = count - begin < PORTION ? count : begin + PORTION;
    int failed = eval_portion(model, batch, begin, end);
    if (failed < first_failed) first_failed = failed;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  Status status = eval_one(model, batch, first_failed);
  if (status == STATUS_OK)
    return status_fail(STATUS_SOLVER, "overlap model '%s': pair %d failed once and not again",
                       model->ops->name, first_failed);
  return status_prefix(status, "overlap model '%s': pair %d", model->ops->name, first_failed);
}

Status contact_overlap_eval(const ContactOverlapModel *model, const ContactOverlapBatch *batch) {
  if (batch->hessian && !contact_overlap_has_hessian(model))
    return status_fail(STATUS_INPUT, "overlap model '%s' has no Hessian", model->ops->name);
  if (!model->ops->minds_finite) TRY(check_finite(batch));
  Status status =
      model->ops->eval_batch ? model->ops->eval_batch(model->self, batch) : eval_each(model, batch);
  if (status != STATUS_OK && model->ops->minds_finite) TRY(check_finite(batch)); // which says more
  return status;
}
