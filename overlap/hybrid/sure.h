// SPDX-License-Identifier: Apache-2.0
// `hybrid` of a `geo`: its V where a bound of the error is small, clip's where it is not.
//
//     pair ─► frame, features ─┬─ ρ ─► V, x̄ ──────────────────────────────┐
//                              └─ b ─► B = V₀ exp b ─► share c of clipping ─┴─► V, ∇V, ∇²V, x̄
//
// b is a small network of the same features, trained to tell the 95 % quantile of ln |V − V*|, and then moved
// by a constant so that of held-out pairs 95 % have |V − V*| ≤ B (split conformal prediction: Papadopoulos et
// al. 2002; Romano, Patterson, Candès 2019 with a learned quantile). The promise is about pairs like those,
// taken together; not about each. With t the error that is asked for (OverlapOptions.doubt) and S the step
// x²(3 − 2x),
//
//     c = S(log₂(B/(t V))),   V_hybrid = (1 − c) V + c V_clip,   V x̄ likewise,
//
// so the network answers alone where B ≤ t V, clipping alone where B ≥ 2 t V. B is as smooth as V, and so is
// what comes out, with all its derivatives by the vertices. Where the frame cannot be had or faces nearly lie
// in one plane, `geo` itself has turned to `exact` or `clip` before. Flags: NET where the network has a part,
// BLENDED where clipping has one too, FALLBACK where the network has none.
#ifndef TETLAP_OVERLAP_HYBRID_SURE_H
#define TETLAP_OVERLAP_HYBRID_SURE_H

#include "overlap/ops.h"

// As `hybrid` has it; `weights` is the path of a `geo`, beside which NAME-bound.safetensors must lie.
extern const OverlapOps overlap_hybrid_sure_ops;

#endif
