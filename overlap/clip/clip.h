// SPDX-License-Identifier: Apache-2.0
// The overlap models `clip`, `clip-scalar` and `clip32`: clipping in double precision, with the exact
// gradient and Hessian of V; `clip32` in single.
//
// `clip-scalar` takes one pair at a time (polytope.h) and has the Hessian. `clip` takes as many pairs at once
// as the processor's vectors have lanes (lanes.h, batch.c). It hands doubtful pairs to `clip-scalar`, and all
// pairs where a Hessian is asked or the processor has no such vectors. `clip-scalar` hands doubtful pairs on
// to `exact`. What one pair gets does not depend on which others come with it.
//
// Let A and B intersect in a polyhedron P (polytope.h), o one of its vertices. For face f of A or B with
// outward area vector S_f, outward unit normal n_f and barycentric coordinates β, let P_f be the part of P's
// boundary on it. In the face's own parameters everything is a number without unit:
//
//   φ_f = |P_f| / |S_f|,   m_fa = ∫_{P_f} β_a dA / |S_f|,   Σ_a m_fa = φ_f.
//
// Volume. P is the union of pyramids from o over the P_f; o is above face f by λ_f(o) of the tetrahedron's
// height, so V = Σ_{f of A} φ_f λ_f(o) V_A + Σ_{g of B} φ_g λ_g(o) V_B. All sums are taken relative to o, so
// that a small P loses no digits.
//
// Centroid. The pyramids' own, weighted: with V_f = φ_f λ_f(o) V_A or V_B and x_f the mean of P_f,
//
//   x̄ = Σ_f V_f (¼ o + ¾ x_f) / V,   φ_f x_f = Σ_a m_fa x_a.
//
// Gradient. A point of face f moves by Σ_a β_a δx_a, and V grows by what the boundary sweeps over:
//
//   ∂V/∂x_a = Σ_{f∋a} m_fa S_f.
//
// Hessian. d(m_fa S_f) = m_fa dS_f + S_f dm_fa. With face (a, b, c) counter-clockwise from outside,
// S_f = ½ (x_b − x_a) × (x_c − x_a), so dS_f = ½ Σ_cyclic δx_a × (x_b − x_c). In the parameters of f, the
// edges of P_f that lie on edges of A do not move; an edge s that lies on face g of B does. At its point p
// with coordinates β in f and γ in g, p leaves the inner side of g by n_g·(Σ_v β_v δx_v − Σ_b γ_b δy_b), and
// s recedes within f by that over sin θ, θ the angle between n_f and n_g. So each such segment s adds, to the
// rows of A and likewise (f ↔ g) to those of B,
//
//   ∂²V/∂x_a∂x_v −= 1/sin θ ∫_s β_a β_v ds n_f n_gᵀ,    ∂²V/∂x_a∂y_b += 1/sin θ ∫_s β_a γ_b ds n_f n_gᵀ.
//
// The integrands are quadratic along s: Simpson's rule is exact. dS_f and the segments are symmetric only
// together. The antisymmetric part of a segment, n_f n_gᵀ − n_g n_fᵀ = −sin θ [t]× with t its direction,
// divided by sin θ does not depend on θ.
//
// Where faces f and g coincide V has one-sided derivatives only: ∇V is that of one side, and 1/sin θ grows
// without bound as they get parallel. In the symmetric part of n_f n_gᵀ, sin θ is taken as at least
// OVERLAP_CLIP_LEAST_SINE: up to there ∇²V is exact, beyond it is bounded and understates how fast ∇V turns.
// Symmetric and unchanged by a translation it is in any case.
//
// Accuracy: |δV| ≤ 1e-9 V, or 1e-12 of the smaller tetrahedron where V is less than 1e-6 of that. With L the
// longest difference of coordinates and L_A 5.7 times the root of A's squared edges, or L if that is less:
// n_f is of edges of A, and λ_f its product with a difference, so rounding does ν_A ∝ L_A² L to det_A · λ.
// And
//
//   |δV| ≤ ½ Σ_{f of A} φ_f (ν_A + ν_B L_A² L_B/(256 |det_B|))
//        + ½ Σ_{g of B} φ_g (ν_B + ν_A L_B² L_A/(256 |det_A|)).
//
// The first are planes that move along their normals. The rest: λ of a flat tetrahedron tell a point's place
// along its faces to ν_B/det_B of L_B only. By so much the other's planes, of L_A², seem to have moved if
// they stand across. `clip`, which sums each face on its own, takes L for L_A and L_B and adds ν/8 λ_f(o)
// for each face that P has (lanes.h). With |δV| so, the moment V x̄ is off by at most L |δV|: |δx̄| ≤ 1e-9 L
// where V is more than 1e-6 of the smaller tetrahedron, and x̄ is within the boxes of both in any case.
// Rounding of well-shaped pairs leaves |δx̄| ≤ 1e-12 L where V is more than 1e-4 of the smaller
// (tests/overlap/test_centroid.c).
//
// Rounding decides whether there is a volume at all where V ≤ 64 of this bound's |δV| (without the last part)
// or Σ φ ≤ 4096 ε: faces that lie on each other but for rounding have φ, and so ∇V, of an overlap. Such pairs
// are handed on, so that V = 0 and ∇V = 0 where `exact` says so.
//
// Where V is small and a tetrahedron flat, φ may be as wrong as V, and nothing is concluded. Pairs for which
// this bound does not do (slivers, mostly) are answered by overlap_exact_ops and flagged FALLBACK; their
// ∇²V is still from clipping, zero if a tetrahedron is too flat for it. In single precision: |δV| ≤ 1e-3 V,
// or 1e-4 of the smaller tetrahedron where V is less than a tenth of that.
#ifndef TETLAP_OVERLAP_CLIP_CLIP_H
#define TETLAP_OVERLAP_CLIP_CLIP_H

#include "overlap/clip/polytope.h"
#include "overlap/ops.h"

extern const OverlapOps overlap_clip_ops, overlap_clip_scalar_ops, overlap_clip32_ops;

#define OVERLAP_CLIP_LEAST_SINE 1e-6

// ∇²V of a polytope, (24, 24); hessian.c.
void overlap_clip_hessian(const OverlapClipPolytope *polytope, const OverlapClipMoments *moments,
                          const double pair[24], double *hessian);

#endif
