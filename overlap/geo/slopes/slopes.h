// SPDX-License-Identifier: Apache-2.0
// How the centroid x̄ of `geo` (overlap/geo/geo.h) follows the 24 coordinates of a pair. With
// α_k = Σ_m c_m e_mk and the places of the planes s_k (1 + σ (P α)_k),
//
//   x̄ = Σ_k s_k (1 + σ (P α)_k) x_k over the planes of the first tetrahedron,
//
// σ ≤ 1 keeps all places positive. What s, P and the planes' own features e do along a direction is pushed
// forward (frame.h, features.h); the coefficients c are pulled back through the network to the features.
#ifndef TETLAP_OVERLAP_GEO_SLOPES_SLOPES_H
#define TETLAP_OVERLAP_GEO_SLOPES_SLOPES_H

#include "net/model/model.h"
#include "overlap/geo/geo.h"

// ∂x̄/∂x of pairs (count, 24): (count, 3, 24), of a model whose network has a centroid. What is blended with
// clipping or answered by it follows it by its second derivatives (overlap/blend.h). Where V is 0, all 0.
Status overlap_geo_slopes_eval(const OverlapGeoModel *model, int count, const double *pairs, double *slopes);

// Adds what a function g has by the network's parameters: Σ ∂g/∂V ∂V/∂w + ∂g/∂x̄ · ∂x̄/∂w, `by` (count, 4), to
// `slope`, in the network's order. V is pinned at the onset (overlap/geo/geo.h), whose ρ depends on w, too.
// Clipping's share of what is blended is as it is.
Status overlap_geo_slopes_train(const OverlapGeoModel *model, const NetModel_f64 *net, int count,
                                const double *pairs, const double *by, double *slope);

#endif
