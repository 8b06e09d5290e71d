// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of vertices that carry a further point of a smooth surface, or of a smooth curve.
//
// A point of a mesh, Σ prior_k x_k over the corners of an edge or a face, lies on a chord of the surface that
// the vertices are on. The weights w nearest to the prior ones,
//
//   min Σ_k (w_k − prior_k)² / pull_k,   pull_k = 1/|ξ_k|²,   subject to   Σ_k w_k q(ξ_k) = q(0)
//
// for all quadratic polynomials q of the tangent plane's coordinates ξ (in units of the vertices' spacing,
// the point at 0), put it on that surface: where the vertices move as a quadratic function, so does the
// point. Affine functions are always kept. Quadratic forms that the vertices do not tell from them (across
// two rows of vertices), or that would take large weights, are left out.
#ifndef TETLAP_CONTACT_SURFACE_SMOOTH_FIT_H
#define TETLAP_CONTACT_SURFACE_SMOOTH_FIT_H

#include <stdbool.h>

#include "base/vec3.h"

enum { CONTACT_FIT_MOST_COUNT = 64 }; // of vertices

// `x` (count) are vertices near the point, count ≤ CONTACT_FIT_MOST_COUNT, the first `own` ≤ 3 of them the
// corners with the weights `prior`. `normal`: of the tangent plane, any length. `weights` (count). False:
// they would be larger than vertices carry well, and are the prior ones.
bool contact_fit_surface(int count, const Vec3 *x, int own, const double *prior, Vec3 normal,
                         double *weights);

// Of a curve through `count` ≤ 4 vertices at these lengths along it: Lagrange's weights at the length `at`.
void contact_fit_curve(int count, const double *along, double at, double *weights);

#endif
