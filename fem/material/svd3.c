// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/svd3.h"

#include <math.h>
#include <stdbool.h>

// Columns are kept apart: a = F v while v runs through products of plane rotations, until the a are
// orthogonal.
typedef struct Columns {
  double a[3][3];
  double v[3][3];
} Columns;

// Cosine of the angle between two columns below which they count as orthogonal: a few roundings of a dot
// product.
static const double orthogonal = 1e-15;
// Convergence is quadratic: five sweeps are usual, the bound only guards against a cycle in the last bit.
enum { MAX_SWEEPS = 24 };

static inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void rotate_pair(double p[3], double q[3], double c, double s) {
  for (int i = 0; i < 3; i++) {
    double old = p[i];
    p[i] = c * old - s * q[i];
    q[i] = s * old + c * q[i];
  }
}

// Makes columns p and q orthogonal by the smaller of the two possible rotations; false: they were.
static inline bool orthogonalise(Columns *columns, int p, int q) {
  double pp = dot(columns->a[p], columns->a[p]), qq = dot(columns->a[q], columns->a[q]);
  double pq = dot(columns->a[p], columns->a[q]);
  if (!(pq * pq > orthogonal * orthogonal * pp * qq)) return false;
  double zeta = (qq - pp) / (2 * pq);
  double t = copysign(1 / (fabs(zeta) + sqrt(1 + zeta * zeta)), zeta);
  double c = 1 / sqrt(1 + t * t), s = c * t;
  rotate_pair(columns->a[p], columns->a[q], c, s);
  rotate_pair(columns->v[p], columns->v[q], c, s);
  return true;
}

// Puts the longer column first by a quarter turn, which keeps det V.
static void order_pair(Columns *columns, int p, int q) {
  if (!(dot(columns->a[p], columns->a[p]) < dot(columns->a[q], columns->a[q]))) return;
  rotate_pair(columns->a[p], columns->a[q], 0, -1);
  rotate_pair(columns->v[p], columns->v[q], 0, -1);
}

// A unit vector perpendicular to the unit vector u: along u × the axis that u has least of.
static void pick_perpendicular(const double u[3], double w[3]) {
  int axis = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(u[i]) < fabs(u[axis])) axis = i;
  int next = (axis + 1) % 3, last = (axis + 2) % 3;
  double length = sqrt(u[next] * u[next] + u[last] * u[last]);
  w[axis] = 0;
  w[next] = u[last] / length;
  w[last] = -u[next] / length;
}

// A column this short beside the longest, in squares, counts as zero: products of such lengths underflow.
static const double negligible = 1e-160;

// The left vectors. The third completes a right-handed frame and takes the sign of det F into σ₃; where F has
// not rank two, any frame around the first will do.
static void complete_frame(double a[3][3], double u[3][3], double sigma[3]) {
  double square[3] = {dot(a[0], a[0]), dot(a[1], a[1]), dot(a[2], a[2])};
  double bound = negligible * square[0];
  bool has_rank_two = !(square[1] <= bound && square[2] <= bound); // NaN in any column must get through
  sigma[0] = sqrt(square[0]);
  sigma[1] = has_rank_two ? sqrt(square[1]) : 0;
  for (int i = 0; i < 3; i++) {
    u[0][i] = sigma[0] == 0 ? i == 0 : a[0][i] / sigma[0];
    if (has_rank_two) u[1][i] = a[1][i] / sigma[1];
  }
  if (!has_rank_two) pick_perpendicular(u[0], u[1]);
  u[2][0] = u[0][1] * u[1][2] - u[0][2] * u[1][1];
  u[2][1] = u[0][2] * u[1][0] - u[0][0] * u[1][2];
  u[2][2] = u[0][0] * u[1][1] - u[0][1] * u[1][0];
  sigma[2] = has_rank_two ? dot(u[2], a[2]) : 0;
}

// 0 for every usual F; else the power of two that brings the largest entry into [½, 1), so that products of
// four lengths neither overflow nor vanish.
static int find_exponent(const double F[9]) {
  static const double usual = 1e10;
  double largest = 0;
  for (int i = 0; i < 9; i++) largest = fmax(largest, fabs(F[i]));
  if ((largest < usual && largest > 1 / usual) || largest == 0 || !isfinite(largest)) return 0;
  int exponent;
  frexp(largest, &exponent);
  return exponent;
}

void fem_svd3_factor(FemSvd3 *svd, const double F[9]) {
  int exponent = find_exponent(F);
  Columns columns = {.v = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      columns.a[j][i] = exponent == 0 ? F[3 * i + j] : ldexp(F[3 * i + j], -exponent);

  for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
    bool was_turned = orthogonalise(&columns, 0, 1);
    was_turned |= orthogonalise(&columns, 1, 2);
    was_turned |= orthogonalise(&columns, 0, 2);
    if (!was_turned) break;
  }
  order_pair(&columns, 0, 1);
  order_pair(&columns, 1, 2);
  order_pair(&columns, 0, 1);

  double u[3][3];
  complete_frame(columns.a, u, svd->sigma);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      svd->U[3 * i + j] = u[j][i];
      svd->V[3 * i + j] = columns.v[j][i];
    }
  if (exponent != 0)
    for (int k = 0; k < 3; k++) svd->sigma[k] = ldexp(svd->sigma[k], exponent);
}

void fem_svd3_rotation(const FemSvd3 *svd, double R[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) R[3 * i + j] = dot(svd->U + 3 * i, svd->V + 3 * j);
}
