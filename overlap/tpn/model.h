// SPDX-License-Identifier: Apache-2.0
// TetrahedronPairNet as an overlap model: `tpn-published` as its authors train it; `tpn` after the paper
// (vertices and tetrahedra in an order of their own, V over the determinant); `tpn-scene` made fit for
// scenes; and `hybrid`, section 5 of the paper. `tpn-bf16` is tpn computed with less precision.
//
//   pair ─ disjoint, by an exact test? ─► V = 0                                       (ghosts: cut, fade)
//     └─► normalised (normalise.h), in one order or both ─► network ─► z, v ─┐
//     ├─► overlap share of the closed form (geo.h), where it fades or blends ─┼─► V, ∇V, ∇²V  (blend.h)
//     ├─► clip, where faces nearly lie in one plane, if asked ────────────────┤
//     └─► exact, where the blend wants it ───────────────────────────────────┘
//
// ∇V is the derivative of this very V, through normalisation, gate, fading and blend. How smooth V is depends
// on the network: with ReLU or max pools ∇V jumps, with SiLU and sums it is continuous. With the
// normalisation Unit V is the same however the pair is moved, turned or stretched, and net force and torque
// of a pair vanish, as far as float32 goes; the order of a tetrahedron's vertices matters in any case.
// With SiLU, sums and Unit there is a ∇²V; it jumps where a band of a blend begins or ends.
//
//              ghosts  gate    orders  coplanar  beyond the range of the training
//   tpn        keep    none    one     keep      counted    likewise tpn-published
//   tpn-scene  fade    status  both    keep      counted
//   hybrid of tpn-scene
//              –       none    both    clip      exact
//
// Why hybrid turns to clipping where faces nearly lie in one plane: meshes whose inner planes coincide have
// kinks in V there, which cancel between neighbouring pairs. The thin pairs among them are answered by the
// exact model, kinks and all; a smooth V of their neighbours would leave a leap of the force, in which a run
// creeps.
//
// `tpn-bf16`: the factors of the network's products are rounded to bf16 and summed in float32, but for
// products with the coordinates. Its gradient is what backpropagation gives with factors rounded likewise:
// the derivative of the network as if rounding were the identity, not of the stairs that rounding makes of V.
//
// `hybrid`: the network's V where the exact test finds an overlap, the status head is confident, the overlap
// share is neither tiny nor deep and the pair is in the training's range; `exact` elsewhere; blended over
// bands in between. The paper lets the network dismiss pairs; here an exact test does, which costs less than
// the network. Flags NET, BLENDED and FALLBACK tell the shares.
//
// Pairs that the normalisation cannot take are answered by the exact model and flagged FALLBACK.
#ifndef TETLAP_OVERLAP_TPN_MODEL_H
#define TETLAP_OVERLAP_TPN_MODEL_H

#include "overlap/ops.h"
#include "overlap/tpn/network.h"

// The weights that ship under these names; `hybrid` (hybrid/hybrid.h) with such a network is
// overlap_tpn_hybrid_ops, whose weights are tpn-scene's unless others are named.
extern const OverlapOps overlap_tpn_ops, overlap_tpn_bf16_ops, overlap_tpn_published_ops,
    overlap_tpn_scene_ops, overlap_tpn_hybrid_ops;

void overlap_tpn_model_destroy(void *self);

// As OverlapOps.
Status overlap_tpn_model_eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer);
Status overlap_tpn_model_eval_batch(const void *self, const OverlapBatch *batch);

// The status logits of pairs (count, 24): positive where the network says that they intersect; with both
// orders the mean; of pairs that the normalisation cannot take −∞.
Status overlap_tpn_model_logits(const void *self, int count, const double *pairs, double *logits);

#endif
