// SPDX-License-Identifier: Apache-2.0
#include "overlap/blend.h"

#include <math.h>
#include <string.h>

#include "overlap/clip/clip.h"

enum { SIZE = OVERLAP_PAIR_SIZE, SQUARE = SIZE * SIZE, ROWS = 3 * SIZE };

// ---- Of a centroid that follows from V and ∇V.

// The centroid as it is found, with its derivatives.
typedef struct Point {
  double at[3], slopes[3][SIZE];
} Point;

// An end of what is common to both bounding boxes, and the coordinate that it is; of boxes that are apart
// there are two.
typedef struct Ends {
  double low, high;
  int low_at, high_at;
} Ends;

static Ends find_ends(const double pair[24], int axis) {
  Ends ends = {-INFINITY, INFINITY, 0, 0};
  for (int t = 0; t < 2; t++) {
    int least = SIZE / 2 * t + axis, most = least;
    for (int i = least; i < SIZE / 2 * (t + 1); i += 3) {
      if (pair[i] < pair[least]) least = i;
      if (pair[i] > pair[most]) most = i;
    }
    if (pair[least] > ends.low) ends.low = pair[least], ends.low_at = least;
    if (pair[most] < ends.high) ends.high = pair[most], ends.high_at = most;
  }
  return ends;
}

static void begin(const Ends ends[3], Point *point) {
  memset(point, 0, sizeof *point);
  for (int c = 0; c < 3; c++) {
    point->at[c] = (ends[c].low + ends[c].high) / 2;
    point->slopes[c][ends[c].low_at] += 0.5;
    point->slopes[c][ends[c].high_at] += 0.5;
  }
}

// x_z − o and (x_z − o)·∇_z V / V of all vertices, and o' − o = ¼ Σ of their products.
typedef struct Arms {
  double arm[8][3], along[8], step[3];
} Arms;

static Arms find_arms(const double pair[24], double volume, const double gradient[24], const Point *point) {
  Arms arms = {.step = {0, 0, 0}};
  for (int z = 0; z < 8; z++) {
    for (int c = 0; c < 3; c++) {
      arms.arm[z][c] = pair[3 * z + c] - point->at[c];
      arms.along[z] += arms.arm[z][c] * gradient[3 * z + c] / volume;
    }
    for (int c = 0; c < 3; c++) arms.step[c] += 0.25 * arms.along[z] * arms.arm[z][c];
  }
  return arms;
}

// The change of o' − o along coordinate i.
static void change_step(const Arms *arms, double volume, const double gradient[24], const double *bend,
                        const Point *point, int i, double change[3]) {
  for (int c = 0; c < 3; c++) change[c] = -arms->step[c] * gradient[i] / volume;
  for (int z = 0; z < 8; z++) {
    double moves[3], along = 0;
    for (int c = 0; c < 3; c++) {
      moves[c] = (i == 3 * z + c) - point->slopes[c][i];
      along += (moves[c] * gradient[3 * z + c] + arms->arm[z][c] * bend[3 * z + c]) / volume;
    }
    for (int c = 0; c < 3; c++) change[c] += 0.25 * (along * arms->arm[z][c] + arms->along[z] * moves[c]);
  }
}

// o ← o', kept between the ends.
static void go_on(const Ends ends[3], const Arms *arms, double changes[SIZE][3], Point *point) {
  for (int c = 0; c < 3; c++) {
    double to = point->at[c] + arms->step[c];
    if (ends[c].low > ends[c].high || to != to) continue; // boxes that are apart; NaN: it stays
    bool is_low = to <= ends[c].low, is_high = !is_low && to >= ends[c].high;
    point->at[c] = is_low ? ends[c].low : is_high ? ends[c].high : to;
    for (int i = 0; i < SIZE; i++)
      point->slopes[c][i] = is_low    ? i == ends[c].low_at
                            : is_high ? i == ends[c].high_at
                                      : point->slopes[c][i] + changes[i][c];
  }
}

void overlap_blend_derive(const double pair[24], double volume, const double gradient[24],
                          const double hessian[576], double slopes[72]) {
  enum { PASSES = 2 }; // as overlap/pair/centroid.c
  Ends ends[3];
  Point point;
  double changes[SIZE][3];
  memset(slopes, 0, ROWS * sizeof *slopes);
  if (!(volume > 0)) return;
  for (int c = 0; c < 3; c++) ends[c] = find_ends(pair, c);
  begin(ends, &point);
  for (int pass = 0; pass < PASSES; pass++) {
    Arms arms = find_arms(pair, volume, gradient, &point);
    for (int i = 0; i < SIZE; i++)
      change_step(&arms, volume, gradient, hessian + SIZE * i, &point, i, changes[i]);
    go_on(ends, &arms, changes, &point);
  }
  memcpy(slopes, point.slopes, sizeof point.slopes);
}

Status overlap_blend_clip(const double pair[24], OverlapBlend *clip) {
  double hessian[SQUARE];
  unsigned flags;
  TRY(overlap_clip_ops.eval_pair(NULL, pair,
                                 &(OverlapAnswer){.volume = &clip->volume,
                                                  .gradient = clip->gradient,
                                                  .hessian = hessian,
                                                  .centroid = clip->centroid,
                                                  .flags = &flags}));
  overlap_blend_derive(pair, clip->volume, clip->gradient, hessian, clip->slopes);
  return STATUS_OK;
}

// x̄ ← x̄ + p (x̄_clip − x̄), p = c V_clip / V.
void overlap_blend_mix(double share, const double share_gradient[24], const OverlapBlend *clip,
                       OverlapBlend *to) {
  double apart = clip->volume - to->volume, volume = to->volume + share * apart;
  if (!(volume > 0)) {
    *to = (OverlapBlend){0};
    return;
  }
  double part = share * clip->volume / volume;
  for (int i = 0; i < SIZE; i++) {
    double mixed =
        to->gradient[i] + share * (clip->gradient[i] - to->gradient[i]) + apart * share_gradient[i];
    double rate = (share_gradient[i] * clip->volume + share * clip->gradient[i] - part * mixed) / volume;
    to->gradient[i] = mixed;
    for (int c = 0; c < 3; c++) {
      double *slope = to->slopes + SIZE * c + i;
      *slope += part * (clip->slopes[SIZE * c + i] - *slope) + rate * (clip->centroid[c] - to->centroid[c]);
    }
  }
  for (int c = 0; c < 3; c++) to->centroid[c] += part * (clip->centroid[c] - to->centroid[c]);
  to->volume = volume;
}

void overlap_blend_turn(const OverlapBlendShare *share, double difference, const double apart[24],
                        const double *other_hessian, double *gradient, double *hessian) {
  for (int i = 0; i < SIZE && hessian; i++)
    for (int j = i; j < SIZE; j++) {
      int at = SIZE * i + j;
      hessian[at] += share->value * (other_hessian[at] - hessian[at]) + share->gradient[i] * apart[j] +
                     apart[i] * share->gradient[j] + difference * share->hessian[at];
      hessian[SIZE * j + i] = hessian[at];
    }
  for (int i = 0; i < SIZE && gradient; i++)
    gradient[i] += share->value * apart[i] + difference * share->gradient[i];
}

void overlap_blend_move(double share, double other_volume, const double other_centroid[3], double *volume,
                        double *centroid) {
  *volume += share * (other_volume - *volume);
  double part = *volume > 0 ? share * other_volume / *volume : 0;
  for (int c = 0; c < 3 && centroid; c++)
    centroid[c] = *volume > 0 ? centroid[c] + part * (other_centroid[c] - centroid[c]) : 0;
}
