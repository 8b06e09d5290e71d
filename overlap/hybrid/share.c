// SPDX-License-Identifier: Apache-2.0
#include "overlap/hybrid/share.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "overlap/ops.h"
#include "overlap/pair/bend.h"
#include "overlap/pair/invariant.h"
#include "overlap/pair/simplex.h"

enum { SIZE = OVERLAP_PAIR_SIZE, HALF = SIZE / 2, FACTORS = 3 };

static const double BEGIN = 0.9, END = 0.98; // r, s

// S(x) and its derivatives by the logarithm that x is linear in.
static OverlapBend step_of(double logarithm, double range) {
  OverlapBend step = overlap_bend_rise(logarithm / range, 1);
  return (OverlapBend){step.value, step.slope / range, step.bend / (range * range)};
}

static bool find_steps(const OverlapHybridSigns *signs, OverlapBend steps[FACTORS]) {
  if (!(signs->volume > 0 && signs->bound > 0)) return false;
  steps[0] = step_of(log(signs->bound / (signs->doubt * signs->volume)), log(2));
  for (int t = 0; t < 2; t++) {
    double size = overlap_invariant_tet_volume(signs->pair + HALF * t),
           share = signs->volume / (BEGIN * size);
    steps[1 + t] = share > 1 ? step_of(log(share), log(END / BEGIN)) : (OverlapBend){0, 0, 0};
  }
  return true;
}

// The product of 1 − S of all factors but f and g.
static double left_by_others(const OverlapBend steps[FACTORS], int f, int g) {
  double product = 1;
  for (int k = 0; k < FACTORS; k++)
    if (k != f && k != g) product *= 1 - steps[k].value;
  return product;
}

double overlap_hybrid_share(const OverlapHybridSigns *signs) {
  OverlapBend steps[FACTORS];
  return find_steps(signs, steps) ? 1 - left_by_others(steps, -1, -1) : 0;
}

double overlap_hybrid_share_by_volume(const OverlapHybridSigns *signs) {
  OverlapBend steps[FACTORS];
  double slope = 0;
  if (!find_steps(signs, steps)) return 0;
  for (int f = 0; f < FACTORS; f++)
    slope += (f == 0 ? -1 : 1) * left_by_others(steps, f, f) * steps[f].slope / signs->volume;
  return slope;
}

// hessian += factor · (∇² ln v), j ≥ i, of v with gradient and Hessian as given.
static void add_log_bend(double factor, double value, const double *gradient, const double *bend,
                         double *hessian) {
  for (int i = 0; i < SIZE; i++)
    for (int j = i; j < SIZE; j++)
      hessian[SIZE * i + j] +=
          factor * (bend[SIZE * i + j] / value - gradient[i] / value * (gradient[j] / value));
}

// The gradients of the three logarithms.
static void find_changes(const OverlapHybridSigns *signs, double changes[FACTORS][SIZE]) {
  memset(changes, 0, FACTORS * sizeof *changes);
  for (int t = 0; t < 2; t++) {
    double lambda[HALF];
    overlap_simplex_volume(signs->pair + HALF * t, lambda);
    for (int i = 0; i < HALF; i++) changes[1 + t][HALF * t + i] = -lambda[i];
  }
  for (int i = 0; i < SIZE; i++) {
    double by_volume = signs->volume_gradient[i] / signs->volume;
    changes[0][i] = signs->bound_gradient[i] / signs->bound - by_volume;
    changes[1][i] += by_volume;
    changes[2][i] += by_volume;
  }
}

// Σ_f K_f s_f′ ∇² of the logarithms.
static void bend_logs(const OverlapHybridSigns *signs, const OverlapBend steps[FACTORS], double *hessian) {
  double factors[FACTORS];
  for (int f = 0; f < FACTORS; f++) factors[f] = left_by_others(steps, f, f) * steps[f].slope;
  add_log_bend(factors[0], signs->bound, signs->bound_gradient, signs->bound_hessian, hessian);
  add_log_bend(factors[1] + factors[2] - factors[0], signs->volume, signs->volume_gradient,
               signs->volume_hessian, hessian);
  for (int t = 0; t < 2; t++) {
    double lambda[HALF];
    if (factors[1 + t] == 0) continue;
    overlap_simplex_volume(signs->pair + HALF * t, lambda);
    overlap_simplex_add_outer(lambda, 0, factors[1 + t], hessian + (SIZE + 1) * HALF * t);
  }
}

double overlap_hybrid_share_derive(const OverlapHybridSigns *signs, double *gradient, double *hessian) {
  OverlapBend steps[FACTORS];
  double changes[FACTORS][SIZE];
  memset(gradient, 0, SIZE * sizeof *gradient);
  if (hessian) memset(hessian, 0, SIZE * SIZE * sizeof *hessian);
  if (!find_steps(signs, steps)) return 0;
  find_changes(signs, changes);
  for (int f = 0; f < FACTORS; f++)
    for (int i = 0; i < SIZE && steps[f].slope != 0; i++)
      gradient[i] += left_by_others(steps, f, f) * steps[f].slope * changes[f][i];
  if (hessian) bend_logs(signs, steps, hessian);
  for (int f = 0; f < FACTORS && hessian; f++)
    for (int g = 0; g < FACTORS; g++) {
      double factor = f == g ? left_by_others(steps, f, f) * steps[f].bend
                             : -left_by_others(steps, f, g) * steps[f].slope * steps[g].slope;
      for (int i = 0; i < SIZE && factor != 0; i++)
        for (int j = i; j < SIZE; j++) hessian[SIZE * i + j] += factor * changes[f][i] * changes[g][j];
    }
  return 1 - left_by_others(steps, -1, -1);
}
