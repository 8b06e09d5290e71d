// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/blend.h"

#include <float.h>
#include <math.h>

// Volumes of the network below this share of the unit simplex are rounded off.
static const double SOFTEST = 1e-3 / 6;

// The width of the bands in which a volume is bent to stay below the smaller tetrahedron's.
static const double BAND = 0.05;

static OverlapBend itself(double x) {
  return (OverlapBend){.value = x, .slope = 1};
}

// max(0, v)/scale, with a parabola in place of the corner where that is asked for.
static OverlapBend clamp(const OverlapTpnRule *rule, double v) {
  double soft = SOFTEST * rule->scale;
  if (rule->rounds && fabs(v) < soft)
    return (OverlapBend){(v + soft) * (v + soft) / (4 * soft) / rule->scale,
                         (v + soft) / (2 * soft) / rule->scale, 1 / (2 * soft) / rule->scale};
  return v > 0 ? (OverlapBend){.value = v / rule->scale, .slope = 1 / rule->scale}
               : (OverlapBend){.value = 0};
}

static OverlapBend inverse(double x) {
  return (OverlapBend){1 / x, -1 / (x * x), 2 / (x * x * x)};
}

// k: what a parabola in place of the corner of |d|, at d = 0, is above it.
static OverlapBend rounding(double d) {
  double sign = d > 0 ? 1 : -1, left = BAND - fabs(d);
  if (left <= 0) return (OverlapBend){.value = 0};
  return (OverlapBend){left * left / (2 * BAND), -sign * left / BAND, 1 / BAND};
}

// c: min(y, 1) with a parabola in place of the corner, below it; 1 less what rounding may add later.
static OverlapBend bound(double y) {
  double left = 1 + BAND - y;
  if (y <= 1 - BAND) return itself(y);
  if (!(left > 0)) return (OverlapBend){.value = 1 - 4 * DBL_EPSILON};
  return (OverlapBend){1 - left * left / (4 * BAND) - 4 * DBL_EPSILON, left / (2 * BAND), -1 / (2 * BAND)};
}

static OverlapBend probability(double z) {
  double p = 1 / (1 + exp(-z));
  return (OverlapBend){p, p * (1 - p), p * (1 - p) * (1 - 2 * p)};
}

// The part of w that the share decides.
static void weigh_share(const OverlapTpnRule *rule, double share, int order, OverlapTpnJet *weight) {
  overlap_tpn_jet_constant(weight, order, 1);
  if (!rule->is_hybrid) return;
  OverlapTpnJet part;
  overlap_tpn_jet_of(weight, order, OVERLAP_TPN_SHARE,
                     overlap_bend_rise(share / rule->touch - 1, 1 / rule->touch));
  overlap_tpn_jet_of(&part, order, OVERLAP_TPN_SHARE,
                     overlap_bend_rise(3 - 2 * share / rule->deep, -2 / rule->deep));
  overlap_tpn_jet_multiply(weight, &part);
}

static void weigh_confidence(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs,
                             OverlapTpnJet *weight) {
  OverlapTpnJet mean, logit;
  overlap_tpn_jet_constant(&mean, weight->order, 0);
  for (int o = 0; o < rule->order_count; o++) {
    overlap_tpn_jet_of(&logit, weight->order, OVERLAP_TPN_LOGIT + o,
                       itself(inputs->of[OVERLAP_TPN_LOGIT + o]));
    overlap_tpn_jet_add(&mean, 1.0 / rule->order_count, &logit);
  }
  overlap_tpn_jet_apply(&mean, overlap_bend_rise(mean.value / rule->logit, 1 / rule->logit));
  overlap_tpn_jet_multiply(weight, &mean);
}

// The range's weights of order o: of the normalised pair, and of the network's volume.
static void weigh_range(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs, int o,
                        OverlapTpnJet *weight) {
  OverlapTpnJet part;
  overlap_tpn_jet_of(&part, weight->order, OVERLAP_TPN_INSIDE + o,
                     itself(inputs->of[OVERLAP_TPN_INSIDE + o]));
  overlap_tpn_jet_multiply(weight, &part);
  overlap_tpn_jet_of(&part, weight->order, OVERLAP_TPN_VOLUME + o,
                     clamp(rule, inputs->of[OVERLAP_TPN_VOLUME + o]));
  overlap_tpn_jet_apply(&part, overlap_range_overlap_weight(&rule->range, part.value));
  overlap_tpn_jet_multiply(weight, &part);
}

static void weigh(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs, int order,
                  OverlapTpnJet *weight) {
  weigh_share(rule, inputs->of[OVERLAP_TPN_SHARE], order, weight);
  if (rule->is_hybrid) weigh_confidence(rule, inputs, weight);
  for (int o = 0; o < rule->order_count && rule->keeps_to_range; o++) weigh_range(rule, inputs, o, weight);
}

bool overlap_tpn_blend_is_exact(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs) {
  OverlapTpnJet weight;
  weigh_share(rule, inputs->of[OVERLAP_TPN_SHARE], 0, &weight);
  for (int o = 0; o < rule->order_count && rule->keeps_to_range; o++)
    weight.value *= inputs->of[OVERLAP_TPN_INSIDE + o];
  return !(weight.value > 0);
}

double overlap_tpn_blend_weight(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs) {
  OverlapTpnJet weight;
  weigh(rule, inputs, 0, &weight);
  return weight.value;
}

bool overlap_tpn_blend_is_beyond(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs) {
  bool is_beyond = false;
  for (int o = 0; o < rule->order_count && rule->has_range; o++) {
    double volume = clamp(rule, inputs->of[OVERLAP_TPN_VOLUME + o]).value;
    is_beyond |= overlap_range_overlap_weight(&rule->range, volume).value < 1;
  }
  return is_beyond;
}

// N: the mean of what the orders tell.
static void mean_of_orders(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs, int order,
                           OverlapTpnJet *net) {
  OverlapTpnJet part, factor;
  overlap_tpn_jet_constant(net, order, 0);
  for (int o = 0; o < rule->order_count; o++) {
    overlap_tpn_jet_of(&part, order, OVERLAP_TPN_VOLUME + o, clamp(rule, inputs->of[OVERLAP_TPN_VOLUME + o]));
    overlap_tpn_jet_of(&factor, order, OVERLAP_TPN_FACTOR + o, itself(inputs->of[OVERLAP_TPN_FACTOR + o]));
    overlap_tpn_jet_multiply(&part, &factor);
    if (rule->gates) {
      overlap_tpn_jet_of(&factor, order, OVERLAP_TPN_LOGIT + o,
                         probability(inputs->of[OVERLAP_TPN_LOGIT + o]));
      overlap_tpn_jet_multiply(&part, &factor);
    }
    overlap_tpn_jet_add(net, 1.0 / rule->order_count, &part);
  }
}

// m, from the volumes of both tetrahedra.
static void find_smaller(const OverlapTpnInputs *inputs, int order, OverlapTpnJet *smaller) {
  OverlapTpnJet sum, ratio, part;
  overlap_tpn_jet_of(&sum, order, OVERLAP_TPN_SIZE, itself(inputs->of[OVERLAP_TPN_SIZE]));
  overlap_tpn_jet_of(&part, order, OVERLAP_TPN_SIZE + 1, itself(inputs->of[OVERLAP_TPN_SIZE + 1]));
  ratio = sum;
  overlap_tpn_jet_add(&ratio, -1, &part);
  *smaller = ratio.value > 0 ? part : sum; // as k's slope has it
  overlap_tpn_jet_add(&sum, 1, &part);
  part = sum;
  overlap_tpn_jet_apply(&part, inverse(part.value));
  overlap_tpn_jet_multiply(&ratio, &part);
  overlap_tpn_jet_apply(&ratio, rounding(ratio.value));
  overlap_tpn_jet_multiply(&ratio, &sum);
  overlap_tpn_jet_add(smaller, -0.5, &ratio);
}

// C: below the smaller tetrahedron's volume.
static void keep_below(const OverlapTpnInputs *inputs, OverlapTpnJet *volume) {
  const double *size = inputs->of + OVERLAP_TPN_SIZE;
  if (volume->value <= (1 - 2 * BAND) * fmin(size[0], size[1])) return; // m is above (1 − b) of it
  OverlapTpnJet smaller, part;
  find_smaller(inputs, volume->order, &smaller);
  part = smaller;
  overlap_tpn_jet_apply(&part, inverse(part.value));
  overlap_tpn_jet_multiply(volume, &part);
  overlap_tpn_jet_apply(volume, bound(volume->value));
  overlap_tpn_jet_multiply(volume, &smaller);
}

// a = (1 − weight) a + weight · b
static void blend_jets(OverlapTpnJet *a, const OverlapTpnJet *weight, const OverlapTpnJet *b) {
  OverlapTpnJet difference = *b;
  overlap_tpn_jet_add(&difference, -1, a);
  overlap_tpn_jet_multiply(&difference, weight);
  overlap_tpn_jet_add(a, 1, &difference);
}

void overlap_tpn_blend_eval(const OverlapTpnRule *rule, const OverlapTpnInputs *inputs, int order,
                            OverlapTpnJet *volume) {
  OverlapTpnJet weight, other;
  mean_of_orders(rule, inputs, order, volume);
  if (rule->fades) {
    overlap_tpn_jet_of(&other, order, OVERLAP_TPN_SHARE,
                       overlap_bend_rise(inputs->of[OVERLAP_TPN_SHARE] / rule->touch, 1 / rule->touch));
    overlap_tpn_jet_multiply(volume, &other);
  }
  if (rule->rounds) keep_below(inputs, volume);
  weigh(rule, inputs, order, &weight);
  if (weight.value < 1) {
    OverlapTpnJet net = *volume;
    overlap_tpn_jet_of(volume, order, OVERLAP_TPN_EXACT, itself(inputs->of[OVERLAP_TPN_EXACT]));
    blend_jets(volume, &weight, &net);
  }
  if (!(inputs->of[OVERLAP_TPN_PLANE] > 0)) return;
  overlap_tpn_jet_of(&weight, order, OVERLAP_TPN_PLANE, itself(inputs->of[OVERLAP_TPN_PLANE]));
  overlap_tpn_jet_of(&other, order, OVERLAP_TPN_CLIP, itself(inputs->of[OVERLAP_TPN_CLIP]));
  blend_jets(volume, &weight, &other);
}
