// SPDX-License-Identifier: Apache-2.0
// The volume of a tetrahedron and its derivatives: with λ_k the gradients of its barycentric coordinates,
//
//     ∂ ln|V|/∂x_k = λ_k,   ∂² ln|V|/∂x_kr ∂x_lc = −λ_kc λ_lr.
#ifndef TETLAP_OVERLAP_PAIR_SIMPLEX_H
#define TETLAP_OVERLAP_PAIR_SIMPLEX_H

#include <math.h>

#include "base/vec3.h"

// |V| [m³], and λ [1/m], which is infinite where V = 0.
static inline double overlap_simplex_volume(const double tet[12], double lambda[12]) {
  Vec3 origin = vec3_at(tet), edge[3], total = {0, 0, 0};
  for (int k = 0; k < 3; k++) edge[k] = vec3_sub(vec3_at(tet + 3 + 3 * k), origin);
  double six = vec3_dot(edge[0], vec3_cross(edge[1], edge[2]));
  for (int k = 0; k < 3; k++) {
    Vec3 slope = vec3_scale(1 / six, vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3]));
    vec3_store(lambda + 3 + 3 * k, slope);
    total = vec3_add(total, slope);
  }
  vec3_store(lambda, vec3_scale(-1, total));
  return fabs(six) / 6;
}

// The 12 × 12 block at `hessian`, of a pair's (24, 24), += parallel · λ_kr λ_lc + crossed · λ_kc λ_lr
static inline void overlap_simplex_add_outer(const double lambda[12], double parallel, double crossed,
                                             double *hessian) {
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++)
      hessian[24 * i + j] +=
          parallel * lambda[i] * lambda[j] + crossed * lambda[i - i % 3 + j % 3] * lambda[j - j % 3 + i % 3];
}

#endif
