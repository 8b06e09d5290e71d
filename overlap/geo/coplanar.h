// SPDX-License-Identifier: Apache-2.0
// Pairs with faces that nearly lie in one plane, which a smooth V cannot answer.
//
// Face k of one tetrahedron may pass through the plane of face l of the other, parallel to it. There V has a
// kink: it grows with the distance on one side only. In a mesh the kinks of neighbouring pairs cancel. A
// smooth V has none where the faces look the same way, and the pair keeps its volume. It has that of faces
// that look at each other, where an overlap begins as a slice. So the sum over a mesh gets a cusp, which
// pulls coinciding planes inside of the bodies together. On two blocks of aligned cubes that was a side force
// of half the lateral area. Therefore such pairs turn to the exact volume, smoothly, by the share
//
//     w = 1 − Π_kl (1 − w_kl),   w_kl = (1 − r_kl / r₀)³ where r_kl < r₀, else 0,
//     r_kl = |q_k ∓ q_l|² / (P_kk P_ll),
//
// q_k being row k of Q: −q_l for faces that look at each other. r is an affine invariant: the squared
// distance of the planes by their distance from the centre. V = (1 − w) V_geo + w V_clip, with all its
// derivatives.
#ifndef TETLAP_OVERLAP_GEO_COPLANAR_H
#define TETLAP_OVERLAP_GEO_COPLANAR_H

#include "base/status.h"
#include "overlap/geo/coplanar_types.h"
#include "overlap/geo/frame.h"

// The nearly coplanar faces of a pair, and their share.
void overlap_geo_coplanar_find(const GeoMatrix *projector, OverlapGeoCoplanar *coplanar);

// ∇w (24) and, unless NULL, ∇²w (24, 24) by the vertices.
void overlap_geo_coplanar_pull(const OverlapGeoFrame *frame, const OverlapGeoCoplanar *coplanar,
                               double gradient[24], double *hessian);

// If the pair has a share, turns volume, gradient, hessian (24 × 24) and centroid of the network to the blend
// and adds OVERLAP_BLENDED to the flags. All but the volume may be NULL; a Hessian needs the gradient. Fails
// as clipping.
Status overlap_geo_coplanar_blend(const OverlapGeoFrame *frame, const double pair[24], double *volume,
                                  double *gradient, double *hessian, double *centroid, unsigned *flags);

// A bound of the network's error, times 1 − share of clip, is a bound of the blend's error. Where the share
// is nearly 1 that would be too small: for meshes whose planes coincide, which the training does not contain,
// it would hold for 84 to 89 % of the pairs instead of 95 %. So only this part of the share is used: it holds
// for 96 %.
#define OVERLAP_GEO_COPLANAR_FADE 0.9

// Reduces a bound, with gradient and Hessian (each may be NULL), by that.
void overlap_geo_coplanar_fade(const OverlapGeoFrame *frame, double *bound, double *gradient,
                               double *hessian);

#endif
