// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that carry their derivatives by the few quantities that the answer for a pair is made of
// (net_blend.h), so that a formula is written once and its first and second derivatives follow.
//
//     (a b)′ = a′ b + a b′,   (a b)″ = a″ b + a′ b′ᵀ + b′ a′ᵀ + a b″,   f(a)″ = f′ a″ + f″ a′ a′ᵀ
#ifndef TETLAP_CONTACT_NET_JET_H
#define TETLAP_CONTACT_NET_JET_H

enum { CONTACT_NET_QUANTITIES = 12 };

typedef struct ContactNetJet {
  int order; // how many derivatives are carried: 0, 1 or 2
  double value;
  double first[CONTACT_NET_QUANTITIES];
  double second[CONTACT_NET_QUANTITIES][CONTACT_NET_QUANTITIES]; // symmetric
} ContactNetJet;

// A function of one number: its value and two derivatives there.
typedef struct ContactNetBend {
  double value, slope, bend;
} ContactNetBend;

// The step S: from 0 for x ≤ 0 to 1 for x ≥ 1, x being a linear function of slope `rate`; NaN: 0. As S(1 − x)
// = 1 − S(x), it falls where x does.
static inline ContactNetBend contact_net_bend_rise(double x, double rate) {
  if (x >= 1) return (ContactNetBend){.value = 1};
  if (!(x > 0)) return (ContactNetBend){.value = 0};
  return (ContactNetBend){x * x * (3 - 2 * x), 6 * x * (1 - x) * rate, 6 * (1 - 2 * x) * rate * rate};
}

static inline void contact_net_jet_constant(ContactNetJet *a, int order, double value) {
  a->order = order;
  a->value = value;
  for (int i = 0; i < CONTACT_NET_QUANTITIES && order > 0; i++) a->first[i] = 0;
  for (int i = 0; i < CONTACT_NET_QUANTITIES && order > 1; i++)
    for (int j = 0; j < CONTACT_NET_QUANTITIES; j++) a->second[i][j] = 0;
}

// A function of the quantity `which` alone.
static inline void contact_net_jet_of(ContactNetJet *a, int order, int which, ContactNetBend f) {
  contact_net_jet_constant(a, order, f.value);
  if (order > 0) a->first[which] = f.slope;
  if (order > 1) a->second[which][which] = f.bend;
}

// a += factor · b
static inline void contact_net_jet_add(ContactNetJet *a, double factor, const ContactNetJet *b) {
  a->value += factor * b->value;
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 0; i++) a->first[i] += factor * b->first[i];
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < CONTACT_NET_QUANTITIES; j++) a->second[i][j] += factor * b->second[i][j];
}

// a = a · b
static inline void contact_net_jet_multiply(ContactNetJet *a, const ContactNetJet *b) {
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < CONTACT_NET_QUANTITIES; j++)
      a->second[i][j] = a->second[i][j] * b->value + a->value * b->second[i][j] + a->first[i] * b->first[j] +
                        a->first[j] * b->first[i];
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 0; i++)
    a->first[i] = a->first[i] * b->value + a->value * b->first[i];
  a->value *= b->value;
}

// a = f(a), f at a's value
static inline void contact_net_jet_apply(ContactNetJet *a, ContactNetBend f) {
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 1; i++)
    for (int j = 0; j < CONTACT_NET_QUANTITIES; j++)
      a->second[i][j] = f.slope * a->second[i][j] + f.bend * a->first[i] * a->first[j];
  for (int i = 0; i < CONTACT_NET_QUANTITIES && a->order > 0; i++) a->first[i] *= f.slope;
  a->value = f.value;
}

#endif
