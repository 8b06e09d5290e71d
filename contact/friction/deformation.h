// SPDX-License-Identifier: GPL-3.0-or-later
// The deformation gradient F of a linear tetrahedron, by rows, as friction carries its stretch with it.
#ifndef TETLAP_CONTACT_FRICTION_DEFORMATION_H
#define TETLAP_CONTACT_FRICTION_DEFORMATION_H

#include <math.h>
#include <stddef.h>

#include "base/vec3.h"
#include "contact/limits.h"

static inline Vec3 contact_deformation_times(const double F[9], Vec3 x) {
  return (Vec3){F[0] * x.x + F[1] * x.y + F[2] * x.z, F[3] * x.x + F[4] * x.y + F[5] * x.z,
                F[6] * x.x + F[7] * x.y + F[8] * x.z};
}

static inline void contact_deformation_transpose(const double F[9], double T[9]) {
  for (int e = 0; e < 9; e++) T[e] = F[e % 3 * 3 + e / 3];
}

// F⁻¹ x, and x itself where F is flat.
static inline Vec3 contact_deformation_divide(const double F[9], Vec3 x) {
  Vec3 r0 = vec3_at(F), r1 = vec3_at(F + 3), r2 = vec3_at(F + 6);
  double det = vec3_dot(r0, vec3_cross(r1, r2)), size = vec3_length(r0) * vec3_length(r1) * vec3_length(r2);
  if (!(fabs(det) > CONTACT_ROUNDING * size)) return x;
  Vec3 sum = vec3_add(vec3_scale(x.x, vec3_cross(r1, r2)), vec3_scale(x.y, vec3_cross(r2, r0)));
  return vec3_scale(1 / det, vec3_add(sum, vec3_scale(x.z, vec3_cross(r0, r1))));
}

// F = Σ_k (x_{k+1} − x_0) rows[k]ᵀ / det over k = 0, 1, 2, by the edges at rest; returns their det.
static inline double contact_deformation_rows(const int v[4], const double *rest, Vec3 rows[3]) {
  Vec3 edge[3];
  for (int k = 0; k < 3; k++)
    edge[k] = vec3_sub(vec3_at(rest + 3 * (size_t)v[k + 1]), vec3_at(rest + 3 * (size_t)v[0]));
  for (int k = 0; k < 3; k++) rows[k] = vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3]);
  return vec3_dot(edge[0], rows[0]);
}

static inline void contact_deformation_find(const int v[4], const double *rest, const double *positions,
                                            double F[9]) {
  Vec3 rows[3];
  double det = contact_deformation_rows(v, rest, rows);
  for (int e = 0; e < 9; e++) F[e] = 0;
  for (int k = 0; k < 3; k++) {
    Vec3 edge = vec3_sub(vec3_at(positions + 3 * (size_t)v[k + 1]), vec3_at(positions + 3 * (size_t)v[0]));
    const double column[3] = {edge.x, edge.y, edge.z};
    for (int r = 0; r < 3; r++) vec3_accumulate(F + 3 * r, vec3_scale(column[r] / det, rows[k]));
  }
}

#endif
