// SPDX-License-Identifier: GPL-3.0-or-later
// How the answer for one pair is made of what a network, the closed form and the exact model say of it, and
// its derivatives by each of them.
//
// The network tells, for each of n orders of the two tetrahedra, a status logit z_o and a volume v_o of the
// normalised pair. With u the volume v clamped at 0, g the gate (the probability σ(z), or 1), f the
// normalisation's factor, and V_e the exact volume,
//
//     V = w r N + (1 − w) V_e,   N = 1/n Σ_o f_o u(v_o)/scale g(z_o).
//
// Fading r(q) and weight w are functions of the pair. q is its overlap share: V₀ (1/V_A + 1/V_B), V₀ the
// closed form of `geo` without a network, which is 0 where the pair is disjoint and has continuous
// derivatives. With S the step x²(3 − 2x) between 0 and 1:
//
//     r = S(q/touch)                                                         where it is asked for
//     w = S(q/touch − 1) · (1 − S(2 q/deep − 2)) · S(z̄/z₁)                   hybrid; else 1
//         · Π_o (weight in the training's range of the pair and of u/scale)  where it is asked for
//
// z̄ is the mean logit, z₁ that of the confidence that is asked for.
#ifndef TETLAP_CONTACT_NET_BLEND_H
#define TETLAP_CONTACT_NET_BLEND_H

#include <stdbool.h>

#include "contact/net_range.h"

enum { CONTACT_NET_MAX_ORDERS = 2 };

// What holds for all pairs.
typedef struct ContactNetRule {
  bool fades, gates, rounds; // r, g; u is rounded off near 0
  bool is_hybrid;
  bool keeps_to_range; // the range decides about w
  bool has_range;
  ContactNetRange range;
  int order_count;
  double touch, deep; // overlap shares
  double logit;       // z₁
  double scale;       // the network tells scale · V'
} ContactNetRule;

// Of a pair, before the network is asked.
typedef struct ContactNetPrior {
  double fading, fading_slope;          // r, dr/dq
  double share, share_slope;            // the part of w that q decides, and its slope
  double range[CONTACT_NET_MAX_ORDERS]; // weights in range of the normalised pairs, 1 where they do not count
} ContactNetPrior;

// `inside`: the range's weight of each order's normalised pair.
ContactNetPrior contact_net_blend_prior(const ContactNetRule *rule, double share,
                                        const double inside[CONTACT_NET_MAX_ORDERS]);
// Whether w = 0 whatever the network says.
bool contact_net_blend_is_exact(const ContactNetRule *rule, const ContactNetPrior *prior);

// What the network says: per order z, v.
typedef struct ContactNetTold {
  double logit[CONTACT_NET_MAX_ORDERS], volume[CONTACT_NET_MAX_ORDERS];
  double factor[CONTACT_NET_MAX_ORDERS];
} ContactNetTold;

typedef struct ContactNetBlend {
  double weight;     // w
  double net;        // N
  double net_weight; // ∂V/∂N
  double excess;     // ∂V/∂w = r N − V_e
  bool is_beyond;    // a u/scale is beyond the range
  // ∂V by the network's outputs, by each weight in range, by q.
  double by_logit[CONTACT_NET_MAX_ORDERS], by_volume[CONTACT_NET_MAX_ORDERS],
      by_range[CONTACT_NET_MAX_ORDERS];
  double by_share;
  double inner[CONTACT_NET_MAX_ORDERS]; // ∂V by the factors: what the normalisation multiplies
} ContactNetBlend;

// w alone, from what the network says.
ContactNetBlend contact_net_blend_weigh(const ContactNetRule *rule, const ContactNetPrior *prior,
                                        const ContactNetTold *told);
// V, and all derivatives; `exact` is V_e, of no account where blend->weight = 1.
double contact_net_blend_settle(const ContactNetRule *rule, const ContactNetPrior *prior,
                                const ContactNetTold *told, double exact, ContactNetBlend *blend);

#endif
