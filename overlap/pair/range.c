// SPDX-License-Identifier: Apache-2.0
#include "overlap/pair/range.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "overlap/pair/simplex.h"

// The share of pairs at each end of each measure that a range leaves out.
static const double TAIL = 0.005;
// The factor by which a measure is beyond the range where the weight is 0.
static const double BAND = 1.5;

static Vec3 centroid_of(const double pair[24]) {
  Vec3 sum = {0, 0, 0};
  for (int v = 0; v < 4; v++) sum = vec3_add(sum, vec3_at(pair + 3 * v));
  return vec3_scale(0.25, sum);
}

static double square_radius(const double pair[24]) {
  Vec3 centre = centroid_of(pair);
  double sum = 0;
  for (int v = 0; v < 8; v++) {
    Vec3 arm = vec3_sub(vec3_at(pair + 3 * v), centre);
    sum += vec3_dot(arm, arm);
  }
  return sum / 8;
}

OverlapRangeMeasures overlap_range_measure(const double pair[24]) {
  double lambda[12];
  OverlapRangeMeasures measures = {.radius = sqrt(square_radius(pair))};
  for (int t = 0; t < 2; t++) measures.volume[t] = overlap_simplex_volume(pair + 12 * t, lambda);
  return measures;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void find_ends(int count, double *values, double ends[2]) {
  qsort(values, (size_t)count, sizeof *values, compare);
  int skipped = (int)(TAIL * count);
  ends[0] = values[skipped];
  ends[1] = values[count - 1 - skipped];
}

OverlapRange overlap_range_of(int count, const OverlapRangeMeasures *measures, const double *overlaps,
                              double *values) {
  OverlapRange range = {.overlap = 0};
  for (int i = 0; i < count; i++) values[i] = measures[i].radius;
  find_ends(count, values, range.radius);
  for (int t = 0; t < 2; t++) {
    for (int i = 0; i < count; i++) values[i] = measures[i].volume[t];
    find_ends(count, values, range.volume[t]);
  }
  int inside = 0;
  double ends[2];
  for (int i = 0; i < count; i++)
    if (overlaps[i] > 0) values[inside++] = overlaps[i];
  if (inside == 0) return range;
  find_ends(inside, values, ends);
  range.overlap = ends[1];
  return range;
}

void overlap_range_print(const OverlapRange *range, char text[OVERLAP_RANGE_TEXT]) {
  snprintf(text, OVERLAP_RANGE_TEXT,
           "radius %.9g to %.9g, first volume %.9g to %.9g, second volume %.9g to %.9g, overlap to %.9g",
           range->radius[0], range->radius[1], range->volume[0][0], range->volume[0][1], range->volume[1][0],
           range->volume[1][1], range->overlap);
}

static bool is_range(const double ends[2]) {
  return ends[0] >= 0 && ends[1] > 0 && ends[1] >= ends[0] && isfinite(ends[1]);
}

bool overlap_range_parse(const char *text, OverlapRange *range) {
  int used = 0;
  if (sscanf(text, "radius %lf to %lf, first volume %lf to %lf, second volume %lf to %lf, overlap to %lf%n",
             &range->radius[0], &range->radius[1], &range->volume[0][0], &range->volume[0][1],
             &range->volume[1][0], &range->volume[1][1], &range->overlap, &used) != 7)
    return false;
  return text[used] == 0 && is_range(range->radius) && is_range(range->volume[0]) &&
         is_range(range->volume[1]) && range->overlap > 0 && isfinite(range->overlap);
}

// Beyond an end by less than this is still within: the text of a range has nine digits.
static const double WITHIN = 1e-6;

// The weight of a measure between two ends, with its derivatives by the measure's logarithm.
static OverlapBend weigh(double value, const double ends[2]) {
  double rate = 1 / log(BAND);
  OverlapBend below = overlap_bend_rise(1 - (log(ends[0] / value) - WITHIN) * rate, rate),
              above = overlap_bend_rise(1 - (log(value / ends[1]) - WITHIN) * rate, -rate);
  return (OverlapBend){below.value * above.value, below.value * above.slope + below.slope * above.value,
                       below.value * above.bend + 2 * below.slope * above.slope + below.bend * above.value};
}

enum { SIZE = 24, MEASURES = 3 };

// ∇ ln radius
static void find_radius_slope(const double pair[24], double slope[24]) {
  Vec3 centre = centroid_of(pair), total = {0, 0, 0};
  double factor = 1 / (8 * square_radius(pair));
  for (int v = 0; v < 8; v++) {
    Vec3 arm = vec3_sub(vec3_at(pair + 3 * v), centre);
    total = vec3_add(total, arm);
    vec3_store(slope + 3 * v, vec3_scale(factor, arm));
  }
  for (int v = 0; v < 4; v++) vec3_accumulate(slope + 3 * v, vec3_scale(-0.25 * factor, total));
}

// hessian += scale · ∇² ln radius, from ∇² of the square R of the radius, which is constant: ∇²R/2R − 2 ∇ln
// ∇lnᵀ.
static void add_radius_curvature(const double pair[24], const double slope[24], double scale,
                                 double *hessian) {
  double factor = scale / (16 * square_radius(pair));
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++) hessian[SIZE * i + j] -= 2 * scale * slope[i] * slope[j];
  for (int v = 0; v < 8; v++)
    for (int w = 0; w < 8; w++) {
      int in_v = v < 4, in_w = w < 4; // of the first tetrahedron, whose centroid it is
      double bend = 2 * (v == w) - 0.5 * (in_v + in_w) + in_v * in_w;
      for (int c = 0; c < 3; c++) hessian[SIZE * (3 * v + c) + 3 * w + c] += factor * bend;
    }
}

// The measures' weights, and the slopes of their logarithms.
typedef struct Weights {
  OverlapBend of[MEASURES]; // radius, volumes
  double slope[MEASURES][SIZE];
} Weights;

static Weights find_weights(const OverlapRange *range, const double pair[24]) {
  OverlapRangeMeasures measures = overlap_range_measure(pair);
  Weights weights = {.of = {weigh(measures.radius, range->radius),
                            weigh(measures.volume[0], range->volume[0]),
                            weigh(measures.volume[1], range->volume[1])}};
  find_radius_slope(pair, weights.slope[0]);
  for (int t = 0; t < 2; t++) overlap_simplex_volume(pair + 12 * t, weights.slope[1 + t] + 12 * t);
  return weights;
}

// The product of the weights other than m and n.
static double others(const Weights *weights, int m, int n) {
  double product = 1;
  for (int k = 0; k < MEASURES; k++)
    if (k != m && k != n) product *= weights->of[k].value;
  return product;
}

static void add_curvature(const double pair[24], const Weights *weights, double *hessian) {
  for (int i = 0; i < SIZE * SIZE; i++) hessian[i] = 0;
  for (int m = 0; m < MEASURES; m++)
    for (int n = 0; n < MEASURES; n++) {
      double factor = others(weights, m, n) *
                      (m == n ? weights->of[m].bend : weights->of[m].slope * weights->of[n].slope);
      if (factor == 0) continue;
      for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
          hessian[SIZE * i + j] += factor * weights->slope[m][i] * weights->slope[n][j];
    }
  double by_radius = others(weights, 0, 0) * weights->of[0].slope;
  if (by_radius != 0) add_radius_curvature(pair, weights->slope[0], by_radius, hessian);
  for (int t = 0; t < 2; t++) {
    double by_volume = others(weights, 1 + t, 1 + t) * weights->of[1 + t].slope;
    if (by_volume != 0)
      overlap_simplex_add_outer(weights->slope[1 + t] + 12 * t, 0, -by_volume, hessian + (SIZE + 1) * 12 * t);
  }
}

double overlap_range_weight(const OverlapRange *range, const double pair[24], double *gradient,
                            double *hessian) {
  Weights weights = find_weights(range, pair);
  for (int i = 0; i < SIZE && gradient; i++) {
    gradient[i] = 0;
    for (int m = 0; m < MEASURES; m++) {
      double factor = others(&weights, m, m) * weights.of[m].slope;
      if (factor != 0) gradient[i] += factor * weights.slope[m][i]; // the slope of a flat one may be infinite
    }
  }
  if (hessian) add_curvature(pair, &weights, hessian);
  return others(&weights, -1, -1);
}

OverlapBend overlap_range_overlap_weight(const OverlapRange *range, double overlap) {
  double width = range->overlap * (BAND - 1);
  return overlap_bend_rise(1 - (overlap - range->overlap) / width, -1 / width);
}
