// SPDX-License-Identifier: Apache-2.0
// The evaluation of one portion of pairs (model.h): which model answers each, and how V, ∇V and ∇²V follow
// from the answers.
//
// clang-format off
//   pairs ─ find_disjoint ─► disjoint or flat: nothing
//             ├─► the blend needs no network: exact
//             └─► a slot ─ network ─► z, v ─► blend (blend.h) ─► V and its derivatives by what it is made of
//                                                                 └─ times theirs by the pair ─► ∇V, ∇²V
// clang-format on
//
// ∇²V is that of this very V, but for the exact model's share in it, whose second derivatives are clipping's.
#ifndef TETLAP_OVERLAP_TPN_PORTION_H
#define TETLAP_OVERLAP_TPN_PORTION_H

#include "overlap/geo/geo.h"
#include "overlap/tpn/blend.h"
#include "overlap/tpn/network.h"

// A portion with second derivatives has at most so many rows.
enum { OVERLAP_TPN_BENT_ROWS = 32 };

typedef struct OverlapTpnModel {
  OverlapTpnNetwork model;
  OverlapTpnRule rule;
  OverlapGhosts ghosts;
  bool turns_to_clip;     // where faces nearly lie in one plane
  OverlapGeoModel closed; // the closed form, where it fades or blends
} OverlapTpnModel;

// The bytes that a portion needs in a workspace.
size_t overlap_tpn_portion_size(void);

// Whether the network's V has second derivatives: it bends everywhere, and only the second tetrahedron's
// normalised coordinates matter.
bool overlap_tpn_portion_has_hessian(const OverlapTpnNetwork *model);

// At most OVERLAP_TPN_ROWS rows, order_count for a pair; with a Hessian, OVERLAP_TPN_BENT_ROWS.
Status overlap_tpn_portion_eval(const OverlapTpnModel *overlap, const OverlapBatch *batch,
                                OverlapTpnWorkspace *workspace);

#endif
