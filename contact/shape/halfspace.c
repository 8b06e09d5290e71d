// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/halfspace.h"

#include <stdbool.h>
#include <string.h>

#include "base/vec3.h"

// Heights in ascending order with the vertices that they belong to.
typedef struct Heights {
  double s[4];
  int below; // how many are negative
} Heights;

static void insert(double *sorted, int count, double value) {
  int i = count;
  for (; i > 0 && sorted[i - 1] > value; i--) sorted[i] = sorted[i - 1];
  sorted[i] = value;
}

static Heights sorted_heights(const double s[4]) {
  Heights heights = {.below = 0};
  for (int i = 0; i < 4; i++) {
    insert(heights.s, i, s[i]);
    heights.below += s[i] < 0;
  }
  return heights;
}

// How far from i, below, the edge to j, above, meets the plane: 0 … 1.
static double crossing(double below, double above) {
  return below / (below - above);
}

// F of a tetrahedron that is cut, in each case a sum of non-negative terms: a corner, a wedge (cut into three
// tetrahedra), all but a corner.
static double fraction_below(Heights heights) {
  const double *s = heights.s;
  if (heights.below == 1) return crossing(s[0], s[1]) * crossing(s[0], s[2]) * crossing(s[0], s[3]);
  if (heights.below == 2) {
    double r02 = crossing(s[0], s[2]), r03 = crossing(s[0], s[3]);
    double r12 = crossing(s[1], s[2]), r13 = crossing(s[1], s[3]);
    double q02 = s[2] / (s[2] - s[0]), q03 = s[3] / (s[3] - s[0]); // 1 − r02, 1 − r03
    return r02 * r03 + q02 * r12 * r13 + q03 * r02 * r13;
  }
  double a = crossing(s[0], s[3]), b = crossing(s[1], s[3]), c = crossing(s[2], s[3]);
  return a + (1 - a) * (b + (1 - b) * c); // 1 − (1 − a)(1 − b)(1 − c)
}

// The B-spline with integral 1 over these ascending knots, at 0, where t₀ < 0 < t_last: by the recurrence of
// de Boor and Cox on the knot spans.
static double spline(const double *t, int count) {
  double m[5] = {0};
  for (int i = 0; i + 1 < count; i++)
    if (t[i] <= 0 && 0 < t[i + 1]) m[i] = 1 / (t[i + 1] - t[i]);
  for (int order = 2; order < count; order++)
    for (int i = 0; i + order < count; i++) {
      double span = t[i + order] - t[i];
      if (span > 0)
        m[i] = order / (order - 1.0) * (-t[i] / span * m[i] + t[i + order] / span * m[i + 1]);
      else
        m[i] = 0; // knots that coincide
    }
  return m[0];
}

// [t₀ … t₄] g
static double cubic(const double t[5]) {
  return spline(t, 5) / 4;
}

// ∂F/∂s_i.
static double first_derivative(Heights heights, double s_i) {
  double t[5];
  memcpy(t, heights.s, sizeof heights.s);
  insert(t, 4, s_i);
  return -cubic(t);
}

// ∂V/∂x_i of the whole tetrahedron, V = sign · det / 6.
static void whole_gradient(const Vec3 edge[4], double sixth, Vec3 gradient[4]) {
  gradient[1] = vec3_scale(sixth, vec3_cross(edge[2], edge[3]));
  gradient[2] = vec3_scale(sixth, vec3_cross(edge[3], edge[1]));
  gradient[3] = vec3_scale(sixth, vec3_cross(edge[1], edge[2]));
  gradient[0] = vec3_scale(-1, vec3_add(gradient[1], vec3_add(gradient[2], gradient[3])));
}

// What V and its derivatives are made of.
typedef struct Cut {
  double s[4]; // heights of the vertices [m]
  Heights heights;
  double fraction;     // F
  double slope[4];     // ∂F/∂s_i
  double whole_volume; // of the tetrahedron
  Vec3 whole[4];       // its gradient
  double sixth;        // 1/6 with the sign of its det
  Vec3 normal;
} Cut;

static bool is_cut(Heights heights) {
  return heights.below > 0 && heights.s[3] > 0;
}

static Cut cut_of(const double tet[12], Vec3 point, Vec3 normal) {
  Cut cut = {.normal = normal};
  Vec3 edge[4];
  for (int i = 0; i < 4; i++) {
    edge[i] = vec3_sub(vec3_at(tet + 3 * i), vec3_at(tet));
    cut.s[i] = vec3_dot(normal, vec3_sub(vec3_at(tet + 3 * i), point));
  }
  cut.heights = sorted_heights(cut.s);
  cut.fraction = is_cut(cut.heights) ? fraction_below(cut.heights) : cut.heights.below > 0;
  double det = vec3_dot(edge[1], vec3_cross(edge[2], edge[3]));
  cut.sixth = det < 0 ? -1.0 / 6 : 1.0 / 6;
  cut.whole_volume = det * cut.sixth;
  whole_gradient(edge, cut.sixth, cut.whole);
  return cut;
}

static void write_gradient(const Cut *cut, double gradient[12]) {
  for (int i = 0; i < 4; i++) {
    Vec3 grown = vec3_scale(cut->fraction, cut->whole[i]);
    vec3_store(gradient + 3 * i, vec3_add(grown, vec3_scale(cut->whole_volume * cut->slope[i], cut->normal)));
  }
}

void contact_halfspace_overlap(const double tet[12], const double point[3], const double normal[3],
                               double *volume, double gradient[12]) {
  Cut cut = cut_of(tet, vec3_at(point), vec3_at(normal));
  *volume = cut.fraction * cut.whole_volume;
  if (!gradient) return;
  for (int i = 0; i < 4 && is_cut(cut.heights); i++) cut.slope[i] = first_derivative(cut.heights, cut.s[i]);
  write_gradient(&cut, gradient);
}

// ---- The mean depth.

// [a b c] max(−t, 0)³ with a ≤ b ≤ c, c > 0.
static double cubed_difference(double a, double b, double c) {
  if (!(a < 0)) return 0;
  if (!(b < 0)) return -a * -a * -a / ((b - a) * (c - a));
  double square = -a * c / ((c - b) * (c - a)) - b / (c - b); // [b c] of a power m is −(−b)ᵐ/(c − b)
  return -a * square + b * b / (c - b);
}

static double depth_below(Heights heights) {
  const double *s = heights.s;
  if (heights.below == 0) return 0;
  if (!is_cut(heights)) return -(s[0] + s[1] + s[2] + s[3]) / 4;
  return 0.25 * (-s[0] * fraction_below(heights) + cubed_difference(s[1], s[2], s[3]));
}

// ∂D/∂s_i.
static double depth_derivative(Heights heights, double s_i) {
  double t[5];
  Heights upper = {.below = 0};
  memcpy(t, heights.s, sizeof heights.s);
  insert(t, 4, s_i);
  for (int k = 0; k < 4; k++) upper.s[k] = t[k + 1], upper.below += t[k + 1] < 0;
  return 0.25 * (t[0] * cubic(t) - (upper.below > 0 ? fraction_below(upper) : 0));
}

static double depth_curvature(Heights heights, double s_i, double s_j) {
  double t[6];
  memcpy(t, heights.s, sizeof heights.s);
  insert(t, 4, s_i);
  insert(t, 5, s_j);
  return spline(t, 6) / 20;
}

void contact_halfspace_press(const double tet[12], const double point[3], const double normal[3],
                             double rest_volume, double *volume, double *energy, double gradient[12],
                             double hessian[144]) {
  Cut cut = cut_of(tet, vec3_at(point), vec3_at(normal));
  bool is_partly = is_cut(cut.heights);
  *volume = cut.fraction * cut.whole_volume;
  *energy = rest_volume * depth_below(cut.heights);
  for (int i = 0; i < 4 && gradient; i++) {
    double slope = is_partly ? depth_derivative(cut.heights, cut.s[i]) : cut.heights.below > 0 ? -0.25 : 0;
    vec3_store(gradient + 3 * i, vec3_scale(rest_volume * slope, cut.normal));
  }
  if (!hessian) return;
  memset(hessian, 0, 144 * sizeof *hessian);
  const double n[3] = {cut.normal.x, cut.normal.y, cut.normal.z};
  for (int i = 0; i < 4 && is_partly; i++)
    for (int j = 0; j < 4; j++) {
      double bend = rest_volume * (1 + (i == j)) * depth_curvature(cut.heights, cut.s[i], cut.s[j]);
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) hessian[12 * (3 * i + r) + 3 * j + c] = bend * n[r] * n[c];
    }
}
