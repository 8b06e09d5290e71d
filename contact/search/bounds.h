// SPDX-License-Identifier: GPL-3.0-or-later
// Bounding boxes of tetrahedra: min x, y, z, max x, y, z.
#ifndef TETLAP_CONTACT_SEARCH_BOUNDS_H
#define TETLAP_CONTACT_SEARCH_BOUNDS_H

#include <math.h>
#include <stddef.h>

static inline void contact_bounds_of_tet(const int tet[4], const double *positions, double box[6]) {
  const double *a = positions + 3 * (size_t)tet[0], *b = positions + 3 * (size_t)tet[1];
  const double *c = positions + 3 * (size_t)tet[2], *d = positions + 3 * (size_t)tet[3];
  for (int k = 0; k < 3; k++) {
    double low_ab = a[k] < b[k] ? a[k] : b[k], low_cd = c[k] < d[k] ? c[k] : d[k];
    double high_ab = a[k] > b[k] ? a[k] : b[k], high_cd = c[k] > d[k] ? c[k] : d[k];
    box[k] = low_ab < low_cd ? low_ab : low_cd;
    box[k + 3] = high_ab > high_cd ? high_ab : high_cd;
  }
}

// Along the axis that separates two boxes best: positive if they are disjoint, 0 if they touch; no more than
// the distance of what they hold.
static inline double contact_bounds_distance(const double a[6], const double b[6]) {
  double distance = -INFINITY;
  for (int k = 0; k < 3; k++) {
    double gap = a[k] - b[k + 3] > b[k] - a[k + 3] ? a[k] - b[k + 3] : b[k] - a[k + 3];
    distance = gap > distance ? gap : distance;
  }
  return distance;
}

#endif
