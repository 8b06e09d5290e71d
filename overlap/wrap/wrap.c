// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/wrap.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/slopes.h"

static void destroy(void *self) {
  OverlapWrap *wrap = self;
  overlap_model_destroy(&wrap->inner);
  pthread_mutex_destroy(&wrap->lock);
  memory_free(wrap->room), memory_free(wrap->integers);
  memory_free(wrap);
}

Status overlap_wrap_reserve(OverlapWrap *wrap, size_t doubles, size_t integers) {
  if (memory_reserve((void **)&wrap->room, &wrap->room_capacity, doubles, sizeof *wrap->room) &&
      memory_reserve((void **)&wrap->integers, &wrap->integer_capacity, integers, sizeof *wrap->integers))
    return STATUS_OK;
  return status_no_memory("pairs for an overlap model");
}

static Status eval_batch(const void *self, const OverlapBatch *batch) {
  OverlapWrap *wrap = (OverlapWrap *)self; // its lock guards what changes
  if (batch->pair_count == 0) return STATUS_OK;
  pthread_mutex_lock(&wrap->lock);
  Status status = wrap->kind->eval(wrap, batch);
  pthread_mutex_unlock(&wrap->lock);
  return status;
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch one = overlap_ops_single(pair, answer);
  return eval_batch(self, &one);
}

static Status eval_pull(const void *self, const OverlapPull *pull) {
  OverlapWrap *wrap = (OverlapWrap *)self;
  if (pull->pair_count == 0) return STATUS_OK;
  pthread_mutex_lock(&wrap->lock);
  Status status = wrap->kind->eval_pull(wrap, pull);
  pthread_mutex_unlock(&wrap->lock);
  return status;
}

static Status eval_slopes(const void *self, int count, const double *pairs, double *slopes) {
  const OverlapWrap *wrap = self;
  return wrap->kind->eval_slopes(wrap, count, pairs, slopes);
}

static Status eval_logits(const void *self, int count, const double *pairs, double *logits) {
  const OverlapWrap *wrap = self;
  if (wrap->kind->eval_logits) return wrap->kind->eval_logits(wrap, count, pairs, logits);
  return wrap->inner.ops->eval_logits(wrap->inner.self, count, pairs, logits);
}

static Status eval_bounds(const void *self, int count, const double *pairs, double *volumes, double *bounds) {
  const OverlapWrap *wrap = self;
  return wrap->inner.ops->eval_bounds(wrap->inner.self, count, pairs, volumes, bounds);
}

static bool has_bounds(const void *self) {
  const OverlapModel *inner = &((const OverlapWrap *)self)->inner;
  return !inner->ops->has_bounds || inner->ops->has_bounds(inner->self);
}

static bool has_ghosts(const void *self) {
  const OverlapWrap *wrap = self;
  return !wrap->kind->answers_disjoint && overlap_model_has_ghosts(&wrap->inner);
}

static bool has_gradient(const void *self) {
  const OverlapWrap *wrap = self;
  return overlap_model_has_gradient(&wrap->inner) &&
         (!wrap->kind->has_gradient || wrap->kind->has_gradient(&wrap->inner));
}

static bool has_hessian(const void *self) {
  const OverlapWrap *wrap = self;
  return !wrap->kind->lacks_hessian && overlap_model_has_hessian(&wrap->inner);
}

static bool has_centroid(const void *self) {
  const OverlapWrap *wrap = self;
  bool has_own = overlap_model_has_own_centroid(&wrap->inner);
  switch (wrap->kind->centroid) {
  case OVERLAP_WRAP_INNER_CENTROID:
    return has_own;
  case OVERLAP_WRAP_MIXED_CENTROID:
    return has_own || overlap_model_has_gradient(&wrap->inner);
  case OVERLAP_WRAP_OWN_CENTROID:
    return true;
  case OVERLAP_WRAP_NO_CENTROID:
    break;
  }
  return false;
}

static bool wants_origins(const void *self) {
  return overlap_model_wants_origins(&((const OverlapWrap *)self)->inner);
}

// Of a centroid of its own they need the gradient alone.
static bool has_slopes(const OverlapWrap *wrap) {
  const OverlapWrapKind *kind = wrap->kind;
  return kind->eval_slopes &&
         (kind->centroid == OVERLAP_WRAP_OWN_CENTROID ? has_gradient(wrap)
                                                      : overlap_slopes_are_there(&wrap->inner));
}

static void fill(OverlapWrap *wrap) {
  const OverlapWrapKind *kind = wrap->kind;
  const OverlapOps *inner = wrap->inner.ops;
  wrap->ops = (OverlapOps){
      .name = wrap->name,
      .help = kind->help,
      .seconds_per_pair = inner->seconds_per_pair,
      .eval_pair = eval_pair,
      .eval_batch = eval_batch,
      .destroy = destroy,
      .has_ghosts = has_ghosts,
      .has_gradient = has_gradient,
      .has_hessian = has_hessian,
      .has_centroid = has_centroid,
      .has_bounds = has_bounds,
      .wants_origins = wants_origins,
      .lacks_scale = inner->lacks_scale,
      .weights = inner->weights,
      .gives_doubt = kind->keeps_doubt && inner->gives_doubt,
      .gives_doubt_gradient = kind->keeps_doubt && inner->gives_doubt_gradient,
      .range = kind->keeps_doubt && !kind->lacks_range ? inner->range : NULL,
      .eval_logits = inner->eval_logits ? eval_logits : NULL,
      .eval_bounds = inner->eval_bounds ? eval_bounds : NULL,
      .eval_pull = kind->eval_pull && inner->eval_pull ? eval_pull : NULL,
      .eval_slopes = has_slopes(wrap) ? eval_slopes : NULL,
  };
}

static Status check(const OverlapWrapKind *kind, double number, const OverlapModel *inner) {
  if (!isnan(number) && !kind->number) return status_fail(STATUS_INPUT, "'%s' takes no number", kind->name);
  if (!isnan(number) && !(number > kind->least && number < kind->most))
    return status_fail(STATUS_INPUT, "'%s': its number, %s, is %g; expected one between %g and %g",
                       kind->name, kind->number, number, kind->least, kind->most);
  return kind->check ? kind->check(inner) : STATUS_OK;
}

Status overlap_wrap_create(OverlapModel *model, const OverlapWrapKind *kind, double number,
                           const char *name) {
  const size_t length = strlen(name) + 1;
  Status status = check(kind, number, model);
  OverlapWrap *wrap = status ? NULL : memory_zeroed(1, sizeof *wrap + length);
  if (!status && !wrap) status = status_no_memory("an overlap model");
  if (status) {
    overlap_model_destroy(model);
    return status;
  }
  wrap->kind = kind, wrap->inner = *model, wrap->number = isnan(number) ? kind->usual : number;
  pthread_mutex_init(&wrap->lock, NULL);
  memcpy(wrap->name, name, length);
  fill(wrap);
  *model = (OverlapModel){&wrap->ops, wrap};
  return STATUS_OK;
}
