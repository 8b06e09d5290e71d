// SPDX-License-Identifier: Apache-2.0
// Numbers that carry their derivatives by the few quantities that the answer for a pair is made of (blend.h).
// A formula is written once, and its first and second derivatives follow.
//
//     (a b)′ = a′ b + a b′,   (a b)″ = a″ b + a′ b′ᵀ + b′ a′ᵀ + a b″,   f(a)″ = f′ a″ + f″ a′ a′ᵀ
#ifndef TETLAP_OVERLAP_TPN_JET_H
#define TETLAP_OVERLAP_TPN_JET_H

#include "overlap/pair/bend.h"

enum { OVERLAP_TPN_QUANTITIES = 14 };

typedef struct OverlapTpnJet {
  int order; // how many derivatives are carried: 0, 1 or 2
  double value;
  double first[OVERLAP_TPN_QUANTITIES];
  double second[OVERLAP_TPN_QUANTITIES][OVERLAP_TPN_QUANTITIES]; // symmetric
} OverlapTpnJet;

static inline void overlap_tpn_jet_constant(OverlapTpnJet *a, int order, double value) {
  a->order = order;
  a->value = value;
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && order > 0; i++) a->first[i] = 0;
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && order > 1; i++)
    for (int j = 0; j < OVERLAP_TPN_QUANTITIES; j++) a->second[i][j] = 0;
}

// A function of the quantity `which` alone.
static inline void overlap_tpn_jet_of(OverlapTpnJet *a, int order, int which, OverlapBend f) {
  overlap_tpn_jet_constant(a, order, f.value);
  if (order > 0) a->first[which] = f.slope;
  if (order > 1) a->second[which][which] = f.bend;
}

// a += factor · b
static inline void overlap_tpn_jet_add(OverlapTpnJet *a, double factor, const OverlapTpnJet *b) {
  a->value += factor * b->value;
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 0; i++) a->first[i] += factor * b->first[i];
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < OVERLAP_TPN_QUANTITIES; j++) a->second[i][j] += factor * b->second[i][j];
}

// a = a · b
static inline void overlap_tpn_jet_multiply(OverlapTpnJet *a, const OverlapTpnJet *b) {
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < OVERLAP_TPN_QUANTITIES; j++)
      a->second[i][j] = a->second[i][j] * b->value + a->value * b->second[i][j] + a->first[i] * b->first[j] +
                        a->first[j] * b->first[i];
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 0; i++)
    a->first[i] = a->first[i] * b->value + a->value * b->first[i];
  a->value *= b->value;
}

// a = f(a), f at a's value
static inline void overlap_tpn_jet_apply(OverlapTpnJet *a, OverlapBend f) {
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < OVERLAP_TPN_QUANTITIES; j++)
      a->second[i][j] = f.slope * a->second[i][j] + f.bend * a->first[i] * a->first[j];
  for (int i = 0; i < OVERLAP_TPN_QUANTITIES && a->order > 0; i++) a->first[i] *= f.slope;
  a->value = f.value;
}

#endif
