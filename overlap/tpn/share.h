// SPDX-License-Identifier: Apache-2.0
// The overlap share of a pair: q = V₀ (1/V_A + 1/V_B), V₀ the closed form of `geo` without a network, which
// is 0 where the pair is disjoint and has continuous derivatives. What networks are faded in by.
#ifndef TETLAP_OVERLAP_TPN_SHARE_H
#define TETLAP_OVERLAP_TPN_SHARE_H

double overlap_tpn_share(const double pair[24], double closed);

// ∇q from V₀ and ∇V₀, and ∇²q (24, 24) from ∇²V₀ (24, 24) too; both Hessians NULL where it is not wanted.
void overlap_tpn_share_bend(const double pair[24], double closed, const double closed_gradient[24],
                            const double *closed_hessian, double gradient[24], double *hessian);

#endif
