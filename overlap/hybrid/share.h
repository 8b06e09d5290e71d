// SPDX-License-Identifier: Apache-2.0
// How much of a pair's answer is clipping's: c, from what a network says of it. With S the step x²(3 − 2x)
// between 0 and 1, B a bound of V's error, t the error asked for, V_A and V_B the two tetrahedra's volumes,
//
//     1 − c = (1 − S(x_B)) (1 − S(x_A)) (1 − S(x_A′)),
//     x_B = log₂(B/(t V)),   x_A = ln(V/(r V_A))/ln(s/r),   x_A′ likewise of V_B,   r = .9, s = .98.
//
// So the network has a part only where B < 2 t V and V < s min(V_A, V_B): what is mixed of V and of
// clipping's V is never above the smaller tetrahedron.
#ifndef TETLAP_OVERLAP_HYBRID_SHARE_H
#define TETLAP_OVERLAP_HYBRID_SHARE_H

// What there is to decide from, of one pair; the derivatives, by the 24 coordinates, only for `derive`.
typedef struct OverlapHybridSigns {
  const double *pair; // (2, 4, 3)
  double doubt;       // t
  double volume, bound;
  const double *volume_gradient, *bound_gradient; // (24)
  const double *volume_hessian, *bound_hessian;   // (24, 24); NULL: not wanted
} OverlapHybridSigns;

// c; 0 where V or B is 0.
double overlap_hybrid_share(const OverlapHybridSigns *signs);

// ∂c/∂V at a given B.
double overlap_hybrid_share_by_volume(const OverlapHybridSigns *signs);

// c, ∇c (24) and, unless NULL, ∇²c (24, 24), of which j ≥ i is written.
double overlap_hybrid_share_derive(const OverlapHybridSigns *signs, double *gradient, double *hessian);

#endif
