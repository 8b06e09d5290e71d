// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene may ask of the models that are a TetrahedronPairNet (net_overlap.h). AUTO: the model's own.
#ifndef TETLAP_CONTACT_NET_OPTIONS_H
#define TETLAP_CONTACT_NET_OPTIONS_H

// What becomes of the volumes that the network tells of pairs that share none.
typedef enum ContactNetGhosts {
  CONTACT_NET_GHOSTS_AUTO,
  CONTACT_NET_GHOSTS_KEEP, // they stay
  CONTACT_NET_GHOSTS_CUT,  // an exact test says who is disjoint: V = 0; V jumps where two begin to touch
  CONTACT_NET_GHOSTS_FADE, // and V is faded in over the first overlap, continuously differentiable
} ContactNetGhosts;

typedef enum ContactNetGate {
  CONTACT_NET_GATE_AUTO,
  CONTACT_NET_GATE_NONE,   // V is the volume head's
  CONTACT_NET_GATE_STATUS, // times the probability that the status head tells, and max(0, v) rounded off
} ContactNetGate;

typedef enum ContactNetOrders {
  CONTACT_NET_ORDERS_AUTO,
  CONTACT_NET_ORDERS_ONE,
  CONTACT_NET_ORDERS_BOTH, // the mean of V(A, B) and V(B, A)
} ContactNetOrders;

// Pairs unlike those of the training (net_range.h).
typedef enum ContactNetBeyond {
  CONTACT_NET_BEYOND_AUTO,
  CONTACT_NET_BEYOND_COUNT, // are counted
  CONTACT_NET_BEYOND_EXACT, // and answered by `exact`, blended over a band
} ContactNetBeyond;

// Pairs with faces that nearly lie in one plane (geo_coplanar.h).
typedef enum ContactNetCoplanar {
  CONTACT_NET_COPLANAR_AUTO,
  CONTACT_NET_COPLANAR_KEEP, // are the network's as any other
  CONTACT_NET_COPLANAR_CLIP, // turn to clipping, the more the nearer
} ContactNetCoplanar;

typedef struct ContactNetOptions {
  ContactNetGhosts ghosts;
  ContactNetGate gate;
  ContactNetOrders orders;
  ContactNetBeyond beyond;
  ContactNetCoplanar coplanar;
  double touch;      // fading and `hybrid`: overlap share at which the network begins to count
  double deep;       // hybrid: overlap share beyond which it no longer does
  double confidence; // hybrid: probability of the status head from which it counts fully; at ½ not at all
} ContactNetOptions;

ContactNetOptions contact_net_options_default(void);

#endif
