// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/net_blend.h"

#include <math.h>

// Volumes of the network below this share of the unit simplex are rounded off.
static const double SOFTEST = 1e-3 / 6;

static ContactNetBend itself(double x) {
  return (ContactNetBend){.value = x, .slope = 1};
}

// max(0, v)/scale, with a parabola in place of the corner where that is asked for.
static ContactNetBend clamp(const ContactNetRule *rule, double v) {
  double soft = SOFTEST * rule->scale;
  if (rule->rounds && fabs(v) < soft)
    return (ContactNetBend){(v + soft) * (v + soft) / (4 * soft) / rule->scale,
                            (v + soft) / (2 * soft) / rule->scale, 1 / (2 * soft) / rule->scale};
  return v > 0 ? (ContactNetBend){.value = v / rule->scale, .slope = 1 / rule->scale}
               : (ContactNetBend){.value = 0};
}

static ContactNetBend probability(double z) {
  double p = 1 / (1 + exp(-z));
  return (ContactNetBend){p, p * (1 - p), p * (1 - p) * (1 - 2 * p)};
}

// The part of w that the share decides.
static void weigh_share(const ContactNetRule *rule, double share, int order, ContactNetJet *weight) {
  contact_net_jet_constant(weight, order, 1);
  if (!rule->is_hybrid) return;
  ContactNetJet part;
  contact_net_jet_of(weight, order, CONTACT_NET_SHARE,
                     contact_net_bend_rise(share / rule->touch - 1, 1 / rule->touch));
  contact_net_jet_of(&part, order, CONTACT_NET_SHARE,
                     contact_net_bend_rise(3 - 2 * share / rule->deep, -2 / rule->deep));
  contact_net_jet_multiply(weight, &part);
}

static void weigh_confidence(const ContactNetRule *rule, const ContactNetSaid *said, ContactNetJet *weight) {
  ContactNetJet mean, logit;
  contact_net_jet_constant(&mean, weight->order, 0);
  for (int o = 0; o < rule->order_count; o++) {
    contact_net_jet_of(&logit, weight->order, CONTACT_NET_LOGIT + o, itself(said->of[CONTACT_NET_LOGIT + o]));
    contact_net_jet_add(&mean, 1.0 / rule->order_count, &logit);
  }
  contact_net_jet_apply(&mean, contact_net_bend_rise(mean.value / rule->logit, 1 / rule->logit));
  contact_net_jet_multiply(weight, &mean);
}

// The range's weights of order o: of the normalised pair, and of the volume that the network tells.
static void weigh_range(const ContactNetRule *rule, const ContactNetSaid *said, int o,
                        ContactNetJet *weight) {
  ContactNetJet part;
  contact_net_jet_of(&part, weight->order, CONTACT_NET_INSIDE + o, itself(said->of[CONTACT_NET_INSIDE + o]));
  contact_net_jet_multiply(weight, &part);
  contact_net_jet_of(&part, weight->order, CONTACT_NET_VOLUME + o,
                     clamp(rule, said->of[CONTACT_NET_VOLUME + o]));
  contact_net_jet_apply(&part, contact_net_range_overlap_weight(&rule->range, part.value));
  contact_net_jet_multiply(weight, &part);
}

static void weigh(const ContactNetRule *rule, const ContactNetSaid *said, int order, ContactNetJet *weight) {
  weigh_share(rule, said->of[CONTACT_NET_SHARE], order, weight);
  if (rule->is_hybrid) weigh_confidence(rule, said, weight);
  for (int o = 0; o < rule->order_count && rule->keeps_to_range; o++) weigh_range(rule, said, o, weight);
}

bool contact_net_blend_is_exact(const ContactNetRule *rule, const ContactNetSaid *said) {
  ContactNetJet weight;
  weigh_share(rule, said->of[CONTACT_NET_SHARE], 0, &weight);
  for (int o = 0; o < rule->order_count && rule->keeps_to_range; o++)
    weight.value *= said->of[CONTACT_NET_INSIDE + o];
  return !(weight.value > 0);
}

double contact_net_blend_weight(const ContactNetRule *rule, const ContactNetSaid *said) {
  ContactNetJet weight;
  weigh(rule, said, 0, &weight);
  return weight.value;
}

bool contact_net_blend_is_beyond(const ContactNetRule *rule, const ContactNetSaid *said) {
  bool is_beyond = false;
  for (int o = 0; o < rule->order_count && rule->has_range; o++) {
    double volume = clamp(rule, said->of[CONTACT_NET_VOLUME + o]).value;
    is_beyond |= contact_net_range_overlap_weight(&rule->range, volume).value < 1;
  }
  return is_beyond;
}

// N: the mean of what the orders tell.
static void tell(const ContactNetRule *rule, const ContactNetSaid *said, int order, ContactNetJet *net) {
  ContactNetJet part, factor;
  contact_net_jet_constant(net, order, 0);
  for (int o = 0; o < rule->order_count; o++) {
    contact_net_jet_of(&part, order, CONTACT_NET_VOLUME + o, clamp(rule, said->of[CONTACT_NET_VOLUME + o]));
    contact_net_jet_of(&factor, order, CONTACT_NET_FACTOR + o, itself(said->of[CONTACT_NET_FACTOR + o]));
    contact_net_jet_multiply(&part, &factor);
    if (rule->gates) {
      contact_net_jet_of(&factor, order, CONTACT_NET_LOGIT + o, probability(said->of[CONTACT_NET_LOGIT + o]));
      contact_net_jet_multiply(&part, &factor);
    }
    contact_net_jet_add(net, 1.0 / rule->order_count, &part);
  }
}

// a = (1 − weight) a + weight · b
static void mix(ContactNetJet *a, const ContactNetJet *weight, const ContactNetJet *b) {
  ContactNetJet difference = *b;
  contact_net_jet_add(&difference, -1, a);
  contact_net_jet_multiply(&difference, weight);
  contact_net_jet_add(a, 1, &difference);
}

void contact_net_blend_eval(const ContactNetRule *rule, const ContactNetSaid *said, int order,
                            ContactNetJet *volume) {
  ContactNetJet weight, other;
  tell(rule, said, order, volume);
  if (rule->fades) {
    contact_net_jet_of(&other, order, CONTACT_NET_SHARE,
                       contact_net_bend_rise(said->of[CONTACT_NET_SHARE] / rule->touch, 1 / rule->touch));
    contact_net_jet_multiply(volume, &other);
  }
  weigh(rule, said, order, &weight);
  if (weight.value < 1) {
    ContactNetJet net = *volume;
    contact_net_jet_of(volume, order, CONTACT_NET_EXACT, itself(said->of[CONTACT_NET_EXACT]));
    mix(volume, &weight, &net);
  }
  if (!(said->of[CONTACT_NET_PLANE] > 0)) return;
  contact_net_jet_of(&weight, order, CONTACT_NET_PLANE, itself(said->of[CONTACT_NET_PLANE]));
  contact_net_jet_of(&other, order, CONTACT_NET_CLIP, itself(said->of[CONTACT_NET_CLIP]));
  mix(volume, &weight, &other);
}
