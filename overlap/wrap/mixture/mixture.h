// SPDX-License-Identifier: Apache-2.0
// The wrappers that give a part of each pair to another answer: V = (1 − c) V_inner + c V_other, V x̄
// likewise, with all derivatives that the inner model has. V_other is that of clipping, or 0.
#ifndef TETLAP_OVERLAP_WRAP_MIXTURE_MIXTURE_H
#define TETLAP_OVERLAP_WRAP_MIXTURE_MIXTURE_H

#include "overlap/wrap/wrap.h"

enum { OVERLAP_WRAP_MIXTURE_PORTION = 16 }; // pairs at once

// c of a portion's pairs, with derivatives by their coordinates up to `order`.
typedef struct OverlapWrapShares {
  double value[OVERLAP_WRAP_MIXTURE_PORTION];
  double gradient[OVERLAP_WRAP_MIXTURE_PORTION][OVERLAP_PAIR_SIZE];
  double hessian[OVERLAP_WRAP_MIXTURE_PORTION][OVERLAP_PAIR_SIZE * OVERLAP_PAIR_SIZE]; // symmetric
} OverlapWrapShares;

typedef struct OverlapWrapMixture {
  bool has_clip; // else V_other is 0
  // `portion` has the inner model's V, and if `by_doubt` the doubt that it gives. Called from several threads
  // at once.
  Status (*share)(const OverlapWrap *wrap, const OverlapBatch *portion, int order, OverlapWrapShares *shares);
  bool by_doubt;
} OverlapWrapMixture;

// Operations of a kind that has a `mixture`.
Status overlap_wrap_mixture_eval(OverlapWrap *wrap, const OverlapBatch *batch);
Status overlap_wrap_mixture_slopes(const OverlapWrap *wrap, int count, const double *pairs, double *slopes);

#endif
