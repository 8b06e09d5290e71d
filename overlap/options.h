// SPDX-License-Identifier: Apache-2.0
// What may be asked of models as they are made. AUTO: the model's own.
#ifndef TETLAP_OVERLAP_OPTIONS_H
#define TETLAP_OVERLAP_OPTIONS_H

// What is done with volumes that the network gives to disjoint pairs.
typedef enum OverlapGhosts {
  OVERLAP_GHOSTS_AUTO,
  OVERLAP_GHOSTS_KEEP, // they stay
  OVERLAP_GHOSTS_CUT,  // V = 0 of pairs that an exact test finds disjoint; V jumps where two begin to touch
  OVERLAP_GHOSTS_FADE, // and V is faded in over the first overlap, continuously differentiable
} OverlapGhosts;

typedef enum OverlapGate {
  OVERLAP_GATE_AUTO,
  OVERLAP_GATE_NONE,   // V is the volume head's
  OVERLAP_GATE_STATUS, // times the status head's probability, and max(0, v) smoothed
} OverlapGate;

typedef enum OverlapOrders {
  OVERLAP_ORDERS_AUTO,
  OVERLAP_ORDERS_ONE,
  OVERLAP_ORDERS_BOTH, // the mean of V(A, B) and V(B, A)
} OverlapOrders;

// Pairs unlike those of the training (pair/range.h).
typedef enum OverlapBeyond {
  OVERLAP_BEYOND_AUTO,
  OVERLAP_BEYOND_COUNT, // are counted
  OVERLAP_BEYOND_EXACT, // and answered by `exact`, blended over a band
} OverlapBeyond;

// Pairs with faces that nearly lie in one plane (geo/coplanar.h).
typedef enum OverlapCoplanar {
  OVERLAP_COPLANAR_AUTO,
  OVERLAP_COPLANAR_KEEP, // are the network's as any other
  OVERLAP_COPLANAR_CLIP, // turn to clipping, the more the nearer
} OverlapCoplanar;

// Volumes that no two tetrahedra share: not finite, below 0, above the smaller one.
typedef enum OverlapUnsound {
  OVERLAP_UNSOUND_AUTO,  // those that are not finite are errors, the others flagged
  OVERLAP_UNSOUND_COUNT, // all are flagged; one that is not finite is 0
  OVERLAP_UNSOUND_FATAL, // all are errors
} OverlapUnsound;

typedef struct OverlapOptions {
  OverlapGhosts ghosts;
  OverlapGate gate;
  OverlapOrders orders;
  OverlapBeyond beyond;
  OverlapCoplanar coplanar;
  OverlapUnsound unsound;
  double touch;      // fading and `hybrid`: overlap share at which the network begins to count
  double deep;       // hybrid: overlap share beyond which it no longer does
  double doubt;      // hybrid of a geo: V's relative error that a bound may reach before clipping begins
  double confidence; // hybrid: probability of the status head from which it counts fully; at ½ not at all
} OverlapOptions;

OverlapOptions overlap_options_default(void);

#endif
