// SPDX-License-Identifier: Apache-2.0
// How the answer for one pair is made of what a network, the closed form, the exact model and clipping say of
// it, and its derivatives by each of them.
//
// The network tells, for each of n orders of the two tetrahedra, a status logit z_o and a volume v_o of the
// normalised pair. With u the volume v clamped at 0, g the gate (the probability σ(z), or 1), f the
// normalisation's factor, V_e the exact volume and V_c that of clipping,
//
//     V = (1 − c) (w C(r N) + (1 − w) V_e) + c V_c,   N = 1/n Σ_o f_o u(v_o)/scale g(z_o).
//
// C keeps a network's volume below m, the smaller of the two tetrahedra's, where u is rounded off; else C(x)
// = x. With b = 1/20 and both corners replaced by parabolas,
//
//     C(x) = m c(x/m),   c(y) = y for y ≤ 1 − b, 1 for y ≥ 1 + b, 1 − (1 + b − y)²/(4 b) between,
//     m = min(V_A, V_B) − ½ (V_A + V_B) k(d),   d = (V_A − V_B)/(V_A + V_B),
//     k(d) = (b − |d|)²/(2 b) for |d| < b, 0 beyond.
//
// Fading r(q) and weight w are functions of the pair. q is its overlap share (share.h). With S the step
// x²(3 − 2x) between 0 and 1:
//
//     r = S(q/touch)                                                         where it is asked for
//     w = S(q/touch − 1) · (1 − S(2 q/deep − 2)) · S(z̄/z₁)                   hybrid; else 1
//         · Π_o (weight in the training's range of the pair and of u/scale)  where it is asked for
//
// z̄ is the mean logit, z₁ that of the confidence that is asked for; c is the share of clipping of pairs whose
// faces nearly lie in one plane (geo/coplanar.h), 0 where it is not asked for.
#ifndef TETLAP_OVERLAP_TPN_BLEND_H
#define TETLAP_OVERLAP_TPN_BLEND_H

#include <stdbool.h>

#include "overlap/pair/range.h"
#include "overlap/tpn/jet.h"

enum { OVERLAP_TPN_MAX_ORDERS = 2 };

// What holds for all pairs.
typedef struct OverlapTpnRule {
  bool fades, gates, rounds; // r, g; u is rounded off near 0, and C bounds
  bool is_hybrid;
  bool keeps_to_range; // the range decides about w
  bool has_range;
  OverlapRange range;
  int order_count;
  double touch, deep; // overlap shares
  double logit;       // z₁
  double scale;       // the network's output is scale · V'
} OverlapTpnRule;

// The quantities that V is made of; the first four have one place for each order.
enum {
  OVERLAP_TPN_LOGIT = 0,  // z
  OVERLAP_TPN_VOLUME = 2, // v
  OVERLAP_TPN_FACTOR = 4, // f
  OVERLAP_TPN_INSIDE = 6, // the range's weight of the normalised pair
  OVERLAP_TPN_SHARE = 8,  // q
  OVERLAP_TPN_EXACT = 9,  // V_e, of no account where w = 1
  OVERLAP_TPN_PLANE = 10, // c
  OVERLAP_TPN_CLIP = 11,  // V_c, of no account where c = 0
  OVERLAP_TPN_SIZE = 12,  // V_A and V_B, two places; of no account where C does not bound
};

typedef struct OverlapTpnInputs {
  double of[OVERLAP_TPN_QUANTITIES];
} OverlapTpnInputs;

// Whether w = 0 whatever the network says; reads the range's weights and the share.
bool overlap_tpn_blend_is_exact(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs);

// w from what the network says.
double overlap_tpn_blend_weight(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs);

// Whether a volume u/scale is beyond the training's range.
bool overlap_tpn_blend_is_beyond(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs);

// V with its derivatives up to `order` by all quantities.
void overlap_tpn_blend_eval(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs, int order,
                            OverlapTpnJet *volume);

#endif
