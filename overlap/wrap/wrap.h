// SPDX-License-Identifier: Apache-2.0
// A model round another, which changes its answers; the same for the program's models and for those of users.
//
//   pairs ─► wrapper ─► inner model ─► V, ∇V, ∇²V, x̄ ─► wrapper ─► V, ∇V, ∇²V, x̄
//
// A wrapper may stand round a wrapper. What it gives is differentiated as far as the inner model is: ∇V is
// the derivative of the very V that comes out. Each kind is a file of its own, listed in kinds.c.
#ifndef TETLAP_OVERLAP_WRAP_WRAP_H
#define TETLAP_OVERLAP_WRAP_WRAP_H

#include <pthread.h>

#include "overlap/model.h"

typedef struct OverlapWrap OverlapWrap;

typedef struct OverlapWrapKind {
  const char *name;
  const char *help;   // one line
  const char *number; // what its number is; NULL: it takes none
  // The number is above `least` and below `most`; where none is given it is `usual`.
  double least, most, usual;
  // Whether the inner model can have it; NULL: each can. STATUS_INPUT: why not.
  Status (*check)(const OverlapModel *inner);
  // As OverlapOps has them. `eval`: one call at a time, and never of no pairs.
  Status (*eval)(OverlapWrap *wrap, const OverlapBatch *batch);
  Status (*eval_slopes)(const OverlapWrap *wrap, int count, const double *pairs, double *slopes);
  Status (*eval_pull)(OverlapWrap *wrap, const OverlapPull *pull); // NULL: there is none
  Status (*eval_logits)(const OverlapWrap *wrap, int count, const double *pairs,
                        double *logits); // NULL: the inner model's
  bool answers_disjoint;                 // by exactly 0
  bool keeps_doubt;                      // the inner model's doubt and range are those of what comes out
  bool lacks_range;                      // but not the range: another order's is asked as well
  bool (*has_gradient)(const OverlapModel *inner); // NULL: where the inner model has one
  bool lacks_hessian;
  enum {
    OVERLAP_WRAP_INNER_CENTROID, // that of the inner model; its own where the inner model has one of its own
    OVERLAP_WRAP_MIXED_CENTROID, // its own, where the inner model has one of either kind
    OVERLAP_WRAP_OWN_CENTROID,   // always its own
    OVERLAP_WRAP_NO_CENTROID,    // from V and ∇V
  } centroid;
  const struct OverlapWrapMixture *mixture; // of those whose operations are mixture/mixture.h's; else NULL
} OverlapWrapKind;

struct OverlapWrap {
  const OverlapWrapKind *kind;
  OverlapModel inner; // owned
  double number;
  pthread_mutex_t lock; // of what is below
  double *room;         // scratch memory of `eval`
  int *integers;        // likewise
  size_t room_capacity, integer_capacity;
  OverlapOps ops;
  char name[]; // of `ops`
};

// Puts a wrapper round *model, which is taken over, also where it fails. `number` NAN: the usual one. `name`
// is what the whole is called. STATUS_INPUT: the inner model cannot have it, or the number is beyond its
// range.
Status overlap_wrap_create(OverlapModel *model, const OverlapWrapKind *kind, double number, const char *name);

// Scratch memory of one call of `eval` for so many numbers. STATUS_MEMORY.
Status overlap_wrap_reserve(OverlapWrap *wrap, size_t doubles, size_t integers);

#endif
