// SPDX-License-Identifier: Apache-2.0
// `hybrid` of a `geo`: its V where a bound of the error is small, clip's where it is not.
//
// clang-format off
//     pair ─► frame, features ─┬─ ρ ─► V, x̄ ──────────────────────────────┐
//                              └─ b ─► B = V₀ exp b ─► share c of clipping ─┴─► V, ∇V, ∇²V, x̄
// clang-format on
//
// b is a small network of the same features, trained to tell the 95 % quantile of ln |V − V*|, and then moved
// by a constant so that of held-out pairs 95 % have |V − V*| ≤ B: split conformal prediction (Papadopoulos et
// al. 2002) of a learned quantile (Romano, Patterson, Candès 2019). The promise is about pairs like those,
// taken together, not about each. The share c of clipping (hybrid/share.h) is 0 where B/V is below the error
// that is asked for (OverlapOptions.doubt), 1 where it is twice that or V is nearly the smaller
// tetrahedron's:
//
//     V_hybrid = (1 − c) V + c V_clip,   V x̄ likewise.
//
// B is as smooth as V, and so is what comes out, with all its derivatives by the vertices. Where the frame
// cannot be computed, `geo` itself has used `exact` before; where faces nearly lie in one plane, it has given
// clip the share w (geo/coplanar.h), and B is 1 − .9 w times the output of the second network. Flags: NET
// where the network has a part, BLENDED where clipping has one too, FALLBACK where the network has none.
#ifndef TETLAP_OVERLAP_HYBRID_SURE_H
#define TETLAP_OVERLAP_HYBRID_SURE_H

#include "overlap/ops.h"

// As `hybrid` has it; `weights` is the path of a `geo`, beside which NAME-bound.safetensors must lie.
extern const OverlapOps overlap_hybrid_sure_ops;

#endif
