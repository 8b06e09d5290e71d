// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/net_blend.h"

#include <math.h>

// Volumes of the network below this share of the unit simplex are rounded off.
static const double SOFTEST = 1e-3 / 6;

// From 0 for x ≤ 0 to 1 for x ≥ 1; NaN: 0.
static double rise(double x, double *slope) {
  *slope = x > 0 && x < 1 ? 6 * x * (1 - x) : 0;
  if (x >= 1) return 1;
  return x > 0 ? x * x * (3 - 2 * x) : 0;
}

ContactNetPrior contact_net_blend_prior(const ContactNetRule *rule, double share,
                                        const double inside[CONTACT_NET_MAX_ORDERS]) {
  ContactNetPrior prior = {.fading = 1, .share = 1};
  if (rule->fades) {
    prior.fading = rise(share / rule->touch, &prior.fading_slope);
    prior.fading_slope /= rule->touch;
  }
  if (rule->is_hybrid) {
    double slope[2], enough = rise(share / rule->touch - 1, &slope[0]),
                     much = rise(2 * share / rule->deep - 2, &slope[1]);
    prior.share = enough * (1 - much);
    prior.share_slope = slope[0] / rule->touch * (1 - much) - enough * slope[1] * 2 / rule->deep;
  }
  for (int o = 0; o < rule->order_count; o++) prior.range[o] = rule->keeps_to_range ? inside[o] : 1;
  return prior;
}

bool contact_net_blend_is_exact(const ContactNetRule *rule, const ContactNetPrior *prior) {
  double weight = prior->share;
  for (int o = 0; o < rule->order_count; o++) weight *= prior->range[o];
  return !(weight > 0);
}

// max(0, v), with a parabola in place of the corner where that is asked for.
static double clamp(const ContactNetRule *rule, double v, double *slope) {
  double soft = SOFTEST * rule->scale;
  if (rule->rounds && fabs(v) < soft) {
    *slope = (v + soft) / (2 * soft);
    return (v + soft) * (v + soft) / (4 * soft);
  }
  *slope = v > 0;
  return v > 0 ? v : 0;
}

static double gate(const ContactNetRule *rule, double z, double *slope) {
  *slope = 0;
  if (!rule->gates) return 1;
  double probability = 1 / (1 + exp(-z));
  *slope = probability * (1 - probability);
  return probability;
}

// The parts that w is made of, and the slopes of those that depend on the network.
typedef struct Weights {
  double confidence, confidence_slope;                                           // by the mean logit
  double overlap[CONTACT_NET_MAX_ORDERS], overlap_slope[CONTACT_NET_MAX_ORDERS]; // by u/scale
} Weights;

static double product(const ContactNetRule *rule, const ContactNetPrior *prior, const Weights *weights) {
  double weight = prior->share * weights->confidence;
  for (int o = 0; o < rule->order_count; o++) weight *= prior->range[o] * weights->overlap[o];
  return weight;
}

static Weights weigh(const ContactNetRule *rule, const ContactNetTold *told, bool *is_beyond) {
  Weights weights = {.confidence = 1};
  double mean = 0, slope;
  *is_beyond = false;
  for (int o = 0; o < rule->order_count; o++) {
    mean += told->logit[o] / rule->order_count;
    weights.overlap[o] = 1;
    if (!rule->has_range) continue;
    double volume = clamp(rule, told->volume[o], &slope) / rule->scale;
    double weight = contact_net_range_overlap_weight(&rule->range, volume, &weights.overlap_slope[o]);
    *is_beyond |= weight < 1;
    if (rule->keeps_to_range)
      weights.overlap[o] = weight;
    else
      weights.overlap_slope[o] = 0;
  }
  if (rule->is_hybrid) {
    weights.confidence = rise(mean / rule->logit, &weights.confidence_slope);
    weights.confidence_slope /= rule->logit;
  }
  return weights;
}

ContactNetBlend contact_net_blend_weigh(const ContactNetRule *rule, const ContactNetPrior *prior,
                                        const ContactNetTold *told) {
  ContactNetBlend blend = {0};
  Weights weights = weigh(rule, told, &blend.is_beyond);
  blend.weight = product(rule, prior, &weights);
  return blend;
}

double contact_net_blend_settle(const ContactNetRule *rule, const ContactNetPrior *prior,
                                const ContactNetTold *told, double exact, ContactNetBlend *blend) {
  *blend = (ContactNetBlend){0};
  Weights weights = weigh(rule, told, &blend->is_beyond);
  int n = rule->order_count;
  double u[CONTACT_NET_MAX_ORDERS], u_slope[CONTACT_NET_MAX_ORDERS], g[CONTACT_NET_MAX_ORDERS],
      g_slope[CONTACT_NET_MAX_ORDERS], w = product(rule, prior, &weights);
  for (int o = 0; o < n; o++) {
    u[o] = clamp(rule, told->volume[o], &u_slope[o]) / rule->scale;
    u_slope[o] /= rule->scale;
    g[o] = gate(rule, told->logit[o], &g_slope[o]);
    blend->net += told->factor[o] * u[o] * g[o] / n;
  }
  blend->weight = w;
  blend->net_weight = w * prior->fading;
  blend->excess = prior->fading * blend->net - (w < 1 ? exact : 0);
  // w by one of its parts is the product of the others. Where w = 1 all slopes are 0.
  double others = w > 0 ? w / weights.confidence : 0;
  for (int o = 0; o < n; o++) {
    blend->inner[o] = blend->net_weight / n * u[o] * g[o];
    blend->by_logit[o] = blend->net_weight / n * told->factor[o] * u[o] * g_slope[o] +
                         blend->excess * others * weights.confidence_slope / n;
    blend->by_volume[o] = blend->net_weight / n * told->factor[o] * g[o] * u_slope[o];
    if (!(w > 0)) continue;
    blend->by_volume[o] += blend->excess * w / weights.overlap[o] * weights.overlap_slope[o] * u_slope[o];
    blend->by_range[o] = rule->keeps_to_range ? blend->excess * w / prior->range[o] : 0;
  }
  if (w > 0)
    blend->by_share =
        w * blend->net * prior->fading_slope + blend->excess * w / prior->share * prior->share_slope;
  return blend->net_weight * blend->net + (w < 1 ? (1 - w) * exact : 0);
}
