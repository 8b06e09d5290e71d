// SPDX-License-Identifier: Apache-2.0
#include "overlap/pair/sizes.h"

#include <math.h>

#include "base/vec3.h"

static double determinant_of(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9)));
}

double overlap_sizes_smaller(const double pair[24]) {
  const double a = determinant_of(pair), b = determinant_of(pair + 12);
  return (a < b ? a : b) / 6;
}
