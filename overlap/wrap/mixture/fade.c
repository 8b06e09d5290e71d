// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/mixture/fade.h"

#include "overlap/geo/geo.h"
#include "overlap/pair/bend.h"
#include "overlap/tpn/share.h"
#include "overlap/wrap/mixture/mixture.h"

enum { SIZE = OVERLAP_PAIR_SIZE, SQUARE = SIZE * SIZE, PORTION = OVERLAP_WRAP_MIXTURE_PORTION };

static const double TOUCH = 0.02; // as tpn-scene

// The closed form of a portion.
typedef struct Closed {
  double volume[PORTION], gradient[PORTION * SIZE], hessian[PORTION * SQUARE];
  unsigned flags[PORTION];
} Closed;

static Status find_closed(const OverlapBatch *portion, int order, Closed *closed) {
  OverlapGeoModel model;
  TRY(overlap_geo_create(&model, NULL));
  return overlap_geo_eval(&model, &(OverlapBatch){.pair_count = portion->pair_count,
                                                  .pairs = portion->pairs,
                                                  .volume = closed->volume,
                                                  .gradient = order > 0 ? closed->gradient : NULL,
                                                  .hessian = order > 1 ? closed->hessian : NULL,
                                                  .flags = closed->flags});
}

// What is left out, 1 − S, with its derivatives.
static void derive(const OverlapBend *step, const double *pair, const Closed *closed, int i, int order,
                   OverlapWrapShares *shares) {
  double *gradient = shares->gradient[i], *hessian = order > 1 ? shares->hessian[i] : NULL, by[SIZE];
  overlap_tpn_share_bend(pair, closed->volume[i], closed->gradient + SIZE * i,
                         hessian ? closed->hessian + SQUARE * i : NULL, by, hessian);
  for (int r = 0; r < SIZE; r++) gradient[r] = -step->slope * by[r];
  for (int r = 0; r < SIZE && hessian; r++)
    for (int c = 0; c < SIZE; c++)
      hessian[SIZE * r + c] = -step->slope * hessian[SIZE * r + c] - step->bend * by[r] * by[c];
}

static void leave_out(OverlapWrapShares *shares, int i, int order) {
  shares->value[i] = 1;
  for (int r = 0; r < SIZE && order > 0; r++) shares->gradient[i][r] = 0;
  for (int r = 0; r < SQUARE && order > 1; r++) shares->hessian[i][r] = 0;
}

static Status share(const OverlapWrap *wrap, const OverlapBatch *portion, int order,
                    OverlapWrapShares *shares) {
  Closed closed;
  TRY(find_closed(portion, order, &closed));
  for (int i = 0; i < portion->pair_count; i++) {
    const double *pair = portion->pairs + SIZE * i;
    leave_out(shares, i, order);
    if (closed.flags[i] & (OVERLAP_DISJOINT | OVERLAP_FLAT)) continue;
    const double q = overlap_tpn_share(pair, closed.volume[i]);
    const OverlapBend step = overlap_bend_rise(q / wrap->number, 1 / wrap->number);
    shares->value[i] = 1 - step.value;
    if (order > 0 && step.slope != 0) derive(&step, pair, &closed, i, order, shares);
  }
  return STATUS_OK;
}

static const OverlapWrapMixture mixture = {.share = share};

const OverlapWrapKind overlap_wrap_fade = {
    .name = "fade",
    .help = "V is faded in over the first overlap, and 0 of disjoint pairs",
    .number = "the share of overlap up to which V is faded in",
    .least = 0,
    .most = 1,
    .usual = TOUCH,
    .eval = overlap_wrap_mixture_eval,
    .eval_slopes = overlap_wrap_mixture_slopes,
    .answers_disjoint = true,
    .centroid = OVERLAP_WRAP_MIXED_CENTROID,
    .mixture = &mixture,
};
