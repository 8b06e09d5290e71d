// SPDX-License-Identifier: Apache-2.0
// The analytic-centre frame of a pair: the affine invariants of two tetrahedra, and a first estimate of V.
//
// At the centre c (centre.h) let m be the 8 × 3 matrix with rows m_k = ∇s_k / s_k, m = Q R with QᵀQ = 1,
// and P = Q Qᵀ. P depends neither on the scale of the planes nor on affine maps of space, and another order
// of planes only permutes it. V is an affine invariant times 1/det R:
//
//     V = V₀ exp φ(P),    V₀ = (100/6) / det R.
//
// For a single simplex V₀ exp φ = V asks for φ = ln 1.28 (s_k = ¼, det R = 128 for V = 1/6): so begins every
// overlap, for a corner enters through a face or an edge crosses an edge, and the other four planes are far.
// There P = P* = diag(1₄ − ¼, 0) but for the order of planes.
//
// How the frame moves with the vertices. A vertex a of the tetrahedron of planes k moved by δx_a changes
// λ_k(y) by −λ_a(y) ∇λ_k·δx_a at every y, so with τ_ka = s_a m_k·δx_a (0 for planes of the other one) and
// t = τ 1
//
//     δm = Θ m,   δ log s = v − t,   Θ = diag(t − v) − τ,   v = m·δc = P (t − τᵀ 1).
//
// v is what keeps Σ m_k = 0, that is c the centre. Then with N = Θ P
//
//     δP = (1 − P) N + ((1 − P) N)ᵀ,   δ log det R = tr N,
//
// and read backwards, with Φ = ∂φ/∂P (symmetric), A = 2 (1 − P) Φ P − P, u = diag A and w = P u,
//
//     ∂ log V/∂x_a = s_a Σ_k m_k G_ka,   G_ka = A_kk − A_ka − w_k + w_a,   k over the planes of a's own.
//
// Everything but m itself is free of units and of the shape of the frame, so nearly flat overlaps lose
// nothing; and Σ_a, Σ x_a ×, Σ x_a· of the gradient are right by construction, whatever Φ is.
#ifndef TETLAP_OVERLAP_GEO_FRAME_H
#define TETLAP_OVERLAP_GEO_FRAME_H

#include "overlap/geo/gate.h"

typedef struct OverlapGeoFrame {
  GeoColumns normal;       // ∇s_k [1/m], by component
  double slack[GEO_LANES]; // s_k at the centre
  GeoColumns scaled;       // m_k [1/m], by component
  GeoColumns basis;        // Q, by column
  GeoMatrix projector;     // P
  double volume;           // V₀ [m³]
  double across[2][4][4];  // as in OverlapGeoGate
  int step_count;          // Newton steps to the centre
  bool is_enclosed;
} OverlapGeoFrame;

// Gate, centre and frame. Only with INSIDE all is valid.
OverlapGeoOutcome overlap_geo_frame(OverlapGeoFrame *frame, const double pair[24]);

// P* of the onset.
void overlap_geo_frame_onset(GeoMatrix *projector);

// What the gradient of log V is made of; kept for the second derivative.
typedef struct OverlapGeoAdjoint {
  GeoMatrix slope;         // Φ P
  GeoMatrix response;      // A
  double shift[GEO_LANES]; // w
  double gradient[24];     // ∂ log V/∂x [1/m]
  double own;              // 1; 0: of φ alone, and A without its −P
} OverlapGeoAdjoint;

// `own` as in OverlapGeoAdjoint, which the bend that follows reads.
void overlap_geo_frame_pull(const OverlapGeoFrame *frame, const GeoMatrix *slope, double own,
                            OverlapGeoAdjoint *adjoint);

// The change of the frame along a direction in the 24 coordinates.
typedef struct OverlapGeoTangent {
  double rate[GEO_LANES]; // δ log s
  GeoColumns scaled;      // δm
  GeoMatrix projector;    // δP
  double log_volume;      // δ log V₀ = −tr N
} OverlapGeoTangent;

void overlap_geo_frame_push(const OverlapGeoFrame *frame, const double direction[24],
                            OverlapGeoTangent *tangent);

// The change of the gradient along a direction, given that of Φ.
void overlap_geo_frame_bend(const OverlapGeoFrame *frame, const OverlapGeoAdjoint *adjoint,
                            const GeoMatrix *slope, const OverlapGeoTangent *tangent,
                            const GeoMatrix *slope_change, double change[24]);

#endif
