// SPDX-License-Identifier: Apache-2.0
#include "overlap/pair/centroid.h"

#include <math.h>

#include "base/vec3.h"

enum { PASSES = 2 };

// What is common to both bounding boxes in one coordinate; of boxes that are apart the point halfway.
typedef struct Range {
  double low, high;
} Range;

static Range common_range(const double pair[24], int axis) {
  double low[2], high[2];
  for (int t = 0; t < 2; t++) {
    low[t] = high[t] = pair[12 * t + axis];
    for (int v = 1; v < 4; v++) {
      low[t] = fmin(low[t], pair[12 * t + 3 * v + axis]);
      high[t] = fmax(high[t], pair[12 * t + 3 * v + axis]);
    }
  }
  Range range = {fmax(low[0], low[1]), fmin(high[0], high[1])};
  if (range.low > range.high) range.low = range.high = range.low + (range.high - range.low) / 2;
  return range;
}

// x̄ − o
static Vec3 moment_about(Vec3 o, const double pair[24], double volume, const double gradient[24]) {
  Vec3 sum = {0, 0, 0};
  for (int z = 0; z < 8; z++) {
    Vec3 arm = vec3_sub(vec3_at(pair + 3 * z), o);
    sum = vec3_add(sum, vec3_scale(vec3_dot(arm, vec3_at(gradient + 3 * z)) / volume, arm));
  }
  return vec3_scale(0.25, sum);
}

// NaN stays where it was.
static double move_within(Range range, double from, double by) {
  double to = from + by;
  return to <= range.low ? range.low : to >= range.high ? range.high : to == to ? to : from;
}

void overlap_centroid_derive(const double pair[24], double volume, const double gradient[24],
                             double centroid[3]) {
  Range ranges[3];
  for (int c = 0; c < 3; c++) {
    ranges[c] = common_range(pair, c);
    centroid[c] = volume == 0 ? 0 : ranges[c].low + (ranges[c].high - ranges[c].low) / 2;
  }
  for (int pass = 0; pass < PASSES && volume != 0; pass++) {
    Vec3 by = moment_about(vec3_at(centroid), pair, volume, gradient);
    centroid[0] = move_within(ranges[0], centroid[0], by.x);
    centroid[1] = move_within(ranges[1], centroid[1], by.y);
    centroid[2] = move_within(ranges[2], centroid[2], by.z);
  }
}
