// SPDX-License-Identifier: Apache-2.0
// The centroid of an intersection from its volume V and ∇V, for models that have no centroid of their own.
//
// P is the intersection, P_f the part of its boundary on face f of either tetrahedron, n the outward normal,
// z the eight vertices, o any point. Since div[(x − o)_k (x − o)] = 4 (x − o)_k,
//
//   4 V (x̄ − o)_k = Σ_f ∫_{P_f} (x − o)_k (x − o)·n dA.
//
// On a face (x − o)·n is constant, so the integrand is linear there, and it is n·w of the displacement w that
// is linear in each tetrahedron with w_z = (x_z − o)_k (x_z − o) at its vertices. V changes by ∫ n·w dA when
// the vertices move by w, so the sum is Σ_z w_z·∇_z V:
//
//   V (x̄ − o) = ¼ Σ_z (x_z − o) [(x_z − o)·∇_z V].
//
// Nothing is divided by the size of a tetrahedron, and either orientation means the same. For the gradient of
// a true volume the sum is the same for every o. For others it is not; o is then the middle of what is common
// to the two bounding boxes, and after that the point found so, which lies nearer to the centroid.
#ifndef TETLAP_OVERLAP_PAIR_CENTROID_H
#define TETLAP_OVERLAP_PAIR_CENTROID_H

// x̄ [m] (3) of a pair (2, 4, 3) [m] with V [m³] and ∇V (2, 4, 3) [m²], within both bounding boxes (where
// these are apart: halfway between them); (0, 0, 0) where V is 0. Finite whatever V and ∇V are.
void overlap_centroid_derive(const double pair[24], double volume, const double gradient[24],
                             double centroid[3]);

#endif
