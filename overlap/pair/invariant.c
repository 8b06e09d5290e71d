// SPDX-License-Identifier: Apache-2.0
#include "overlap/pair/invariant.h"

#include <float.h>
#include <math.h>

#include "base/vec3.h"

// In long double: of a sliver of volume 1e-12 double would leave four digits.
static long double tet_volume_long(const double tet[12]) {
  long double d[9];
  for (int i = 0; i < 9; i++) d[i] = (long double)tet[3 + i] - tet[i % 3];
  return fabsl(d[0] * (d[4] * d[8] - d[5] * d[7]) + d[1] * (d[5] * d[6] - d[3] * d[8]) +
               d[2] * (d[3] * d[7] - d[4] * d[6])) /
         6;
}

double overlap_invariant_tet_volume(const double tet[12]) {
  return (double)tet_volume_long(tet);
}

double overlap_invariant_smaller_volume(const double x[24]) {
  return fmin(overlap_invariant_tet_volume(x), overlap_invariant_tet_volume(x + 12));
}

double overlap_invariant_extent(const double x[24]) {
  double longest = 0;
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < i; j++)
      longest = fmax(longest, vec3_length(vec3_sub(vec3_at(x + 3 * i), vec3_at(x + 3 * j))));
  return longest;
}

double overlap_invariant_bounds(const double x[24], double volume) {
  long double a = tet_volume_long(x), b = tet_volume_long(x + 12), smaller = a < b ? a : b;
  long double beyond = fabsl((long double)volume - smaller / 2) - smaller / 2;
  long double rounding = 4 * LDBL_EPSILON * powl(overlap_invariant_extent(x), 3);
  if (!isfinite(volume)) return NAN;
  return beyond > rounding ? (double)(beyond / smaller) : 0;
}

double overlap_invariant_translation(const double x[24], const double gradient[24]) {
  Vec3 sum = {0, 0, 0};
  double length = overlap_invariant_extent(x);
  for (int i = 0; i < 8; i++) sum = vec3_add(sum, vec3_at(gradient + 3 * i));
  return vec3_length(sum) / (length * length);
}

double overlap_invariant_rotation(const double x[24], const double gradient[24]) {
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < 8; i++)
    sum = vec3_add(sum, vec3_cross(vec3_sub(vec3_at(x + 3 * i), vec3_at(x)), vec3_at(gradient + 3 * i)));
  return vec3_length(sum) / pow(overlap_invariant_extent(x), 3);
}

double overlap_invariant_scaling(const double x[24], double volume, const double gradient[24]) {
  double sum = -3 * volume;
  for (int i = 0; i < 8; i++)
    sum += vec3_dot(vec3_sub(vec3_at(x + 3 * i), vec3_at(x)), vec3_at(gradient + 3 * i));
  return fabs(sum) / pow(overlap_invariant_extent(x), 3);
}

double overlap_invariant_allowed(const double x[24], double reference) {
  double smaller = overlap_invariant_smaller_volume(x);
  return reference > 1e-6 * smaller ? 1e-9 * reference : 1e-12 * smaller;
}
