// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/net_range.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/vec3.h"

const double contact_net_range_tail = 0.005;
const double contact_net_range_band = 1.5;

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

// Six times the signed volume, and its derivatives by vertices 1 … 3.
static double determinant(const double tet[12], Vec3 normal[3]) {
  Vec3 origin = vec3_at(tet), edge[3];
  for (int k = 0; k < 3; k++) edge[k] = vec3_sub(vec3_at(tet + 3 + 3 * k), origin);
  for (int k = 0; k < 3; k++) normal[k] = vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3]);
  return vec3_dot(edge[0], normal[0]);
}

ContactNetMeasures contact_net_range_measure(const double pair[24]) {
  Vec3 normal[3];
  ContactNetMeasures measures = {.radius = sqrt(square_radius(pair))};
  for (int t = 0; t < 2; t++) measures.volume[t] = fabs(determinant(pair + 12 * t, normal)) / 6;
  return measures;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void find_ends(int count, double *values, double ends[2]) {
  qsort(values, (size_t)count, sizeof *values, compare);
  int skipped = (int)(contact_net_range_tail * count);
  ends[0] = values[skipped];
  ends[1] = values[count - 1 - skipped];
}

ContactNetRange contact_net_range_of(int count, const ContactNetMeasures *measures, const double *overlaps,
                                     double *values) {
  ContactNetRange range = {.overlap = 0};
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

void contact_net_range_print(const ContactNetRange *range, char text[CONTACT_NET_RANGE_TEXT]) {
  snprintf(text, CONTACT_NET_RANGE_TEXT,
           "radius %.9g to %.9g, first volume %.9g to %.9g, second volume %.9g to %.9g, overlap to %.9g",
           range->radius[0], range->radius[1], range->volume[0][0], range->volume[0][1], range->volume[1][0],
           range->volume[1][1], range->overlap);
}

static bool is_range(const double ends[2]) {
  return ends[0] >= 0 && ends[1] > 0 && ends[1] >= ends[0] && isfinite(ends[1]);
}

bool contact_net_range_parse(const char *text, ContactNetRange *range) {
  int used = 0;
  if (sscanf(text, "radius %lf to %lf, first volume %lf to %lf, second volume %lf to %lf, overlap to %lf%n",
             &range->radius[0], &range->radius[1], &range->volume[0][0], &range->volume[0][1],
             &range->volume[1][0], &range->volume[1][1], &range->overlap, &used) != 7)
    return false;
  return text[used] == 0 && is_range(range->radius) && is_range(range->volume[0]) &&
         is_range(range->volume[1]) && range->overlap > 0 && isfinite(range->overlap);
}

// 1 for x ≤ 0, 0 for x ≥ 1 and for NaN.
static double fall(double x, double *derivative) {
  *derivative = x > 0 && x < 1 ? -6 * x * (1 - x) : 0;
  if (x <= 0) return 1;
  return x < 1 ? 1 - x * x * (3 - 2 * x) : 0;
}

// Beyond an end by less than this is still within: the text of a range has nine digits.
static const double WITHIN = 1e-6;

// The weight of a measure between two ends, in its logarithm; `derivative` by the logarithm.
static double weigh(double value, const double ends[2], double *derivative) {
  double band = log(contact_net_range_band), slope[2];
  double below = fall((log(ends[0] / value) - WITHIN) / band, &slope[0]);
  double above = fall((log(value / ends[1]) - WITHIN) / band, &slope[1]);
  *derivative = (above * -slope[0] + below * slope[1]) / band;
  return below * above;
}

// gradient += scale · ∇ ln radius
static void add_radius(const double pair[24], double scale, double gradient[24]) {
  Vec3 centre = centroid_of(pair), total = {0, 0, 0};
  double factor = scale / (8 * square_radius(pair));
  for (int v = 0; v < 8; v++) {
    Vec3 arm = vec3_sub(vec3_at(pair + 3 * v), centre);
    total = vec3_add(total, arm);
    vec3_accumulate(gradient + 3 * v, vec3_scale(factor, arm));
  }
  for (int v = 0; v < 4; v++) vec3_accumulate(gradient + 3 * v, vec3_scale(-0.25 * factor, total));
}

// gradient += scale · ∇ ln volume
static void add_volume(const double tet[12], double scale, double gradient[12]) {
  Vec3 normal[3], total = {0, 0, 0};
  double factor = scale / determinant(tet, normal);
  for (int k = 0; k < 3; k++) {
    total = vec3_add(total, normal[k]);
    vec3_accumulate(gradient + 3 + 3 * k, vec3_scale(factor, normal[k]));
  }
  vec3_accumulate(gradient, vec3_scale(-factor, total));
}

double contact_net_range_weight(const ContactNetRange *range, const double pair[24], double gradient[24]) {
  ContactNetMeasures measures = contact_net_range_measure(pair);
  double slope[3], weight[3] = {weigh(measures.radius, range->radius, &slope[0]),
                                weigh(measures.volume[0], range->volume[0], &slope[1]),
                                weigh(measures.volume[1], range->volume[1], &slope[2])};
  if (gradient) {
    for (int i = 0; i < 24; i++) gradient[i] = 0;
    double share[3] = {slope[0] * weight[1] * weight[2], weight[0] * slope[1] * weight[2],
                       weight[0] * weight[1] * slope[2]};
    if (share[0] != 0) add_radius(pair, share[0], gradient);
    for (int t = 0; t < 2; t++)
      if (share[1 + t] != 0) add_volume(pair + 12 * t, share[1 + t], gradient + 12 * t);
  }
  return weight[0] * weight[1] * weight[2];
}

double contact_net_range_overlap_weight(const ContactNetRange *range, double overlap, double *derivative) {
  double width = range->overlap * (contact_net_range_band - 1);
  double weight = fall((overlap - range->overlap) / width, derivative);
  *derivative /= width;
  return weight;
}
