// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick_told.h"

#include <math.h>

#include "base/vec3.h"

// The given vertices that carry a vertex, of those with a weight above 0; the weights' sum is made 1.
typedef struct Carriers {
  int count;
  const int *nodes;
  const double *weights;
  double whole;
} Carriers;

static Carriers carriers_of(const ContactStick *stick, const int *vertex) {
  static const double ONE = 1;
  const ContactStars *stars = stick->stars;
  if (!stars || !stars->is_needed) return (Carriers){1, vertex, &ONE, 1};
  int begin = stars->begin[*vertex];
  Carriers carriers = {stars->begin[*vertex + 1] - begin, stars->nodes + begin, stars->weights + begin, 0};
  for (int k = 0; k < carriers.count; k++) carriers.whole += fmax(carriers.weights[k], 0);
  return carriers;
}

static void add_weight(const ContactStick *stick, const ContactStickTold *told, int vertex, double weight,
                       double share_that_slides) {
  Carriers carriers = carriers_of(stick, &vertex);
  for (int k = 0; k < carriers.count; k++) {
    double part = weight * fmax(carriers.weights[k], 0) / carriers.whole;
    told->weights[carriers.nodes[k]][0] += part * (1 - share_that_slides);
    told->weights[carriers.nodes[k]][1] += part * share_that_slides;
  }
}

static void add_work(const ContactStick *stick, const ContactStickTold *told, int vertex, double work) {
  Carriers carriers = carriers_of(stick, &vertex);
  for (int k = 0; k < carriers.count; k++)
    told->works[carriers.nodes[k]] += work * fmax(carriers.weights[k], 0) / carriers.whole;
}

// Of a vertex that is one of the given ones.
static void add_slip(const ContactStick *stick, const double *depths, const ContactStickTold *told,
                     int vertex, const double slid[3], double way) {
  int given = stick->stars ? contact_stars_given(stick->stars, vertex) : vertex;
  if (given < 0 || depths[vertex] > 0) return;
  told->ways[given] += way;
  if (slid) vec3_accumulate(told->slips[given], vec3_at(slid));
}

static void tell_node(const ContactStick *stick, const double *depths, const ContactStickNode *node,
                      const ContactStickTold *told) {
  add_weight(stick, told, node->vertex, node->weight, contact_stick_slides(node));
  add_work(stick, told, node->vertex, node->work);
  add_slip(stick, depths, told, node->vertex, node->slid, node->way);
}

// The share of a pair that slides, by the vertices of its slaves.
static double share_that_slides(const ContactStick *stick, int k) {
  double whole = 0, slides = 0;
  for (int t = 0; t < 8; t++) {
    const ContactStickTouch *touch = &stick->touches[k][t / 4][t % 4];
    if (touch->node < 0) continue;
    const ContactStickNode *node = &stick->nodes[touch->node];
    whole += touch->share * node->weight;
    slides += contact_stick_slides(node) ? touch->share * node->weight : 0;
  }
  return whole > 0 ? slides / whole : 0;
}

// The vertices of a pair's side that is no slave.
static void tell_master(const ContactStick *stick, int k, int side, const ContactStickTold *told) {
  const ContactStickPair *pair = &stick->pairs[k];
  if (pair->tets[side] < 0 || stick->laws[pair->interface].weight[side] > 0) return;
  double pressed = vec3_length(vec3_at(pair->force)), share = share_that_slides(stick, k);
  for (int v = 0; v < 4; v++)
    if (pair->lambda[side][v] > 0)
      add_weight(stick, told, stick->tets[pair->tets[side]][v], pair->lambda[side][v] * pressed, share);
}

// One at rest, or one that has left with what its spring stored.
static void tell_entry(const ContactStick *stick, const double *depths, const ContactStickEntry *entry,
                       bool is_resting, const ContactStickTold *told) {
  int vertex = (int)entry->vertex;
  add_work(stick, told, vertex, entry->work + (is_resting ? 0 : entry->energy));
  add_slip(stick, depths, told, vertex, is_resting ? entry->slid : NULL, entry->way);
  if (is_resting) add_weight(stick, told, vertex, entry->limit, entry->slides);
}

void contact_stick_tell(const ContactStick *stick, const ContactStickHistory *history, const bool *is_resting,
                        const double *depths, const ContactStickTold *told) {
  for (int n = 0; n < stick->node_count; n++) tell_node(stick, depths, &stick->nodes[n], told);
  for (int k = 0; k < stick->pair_count; k++)
    for (int side = 0; side < 2; side++) tell_master(stick, k, side, told);
  for (int i = 0; i < history->entry_count; i++) {
    const ContactStickEntry *entry = &history->entries[i];
    if (stick->has_left[i])
      tell_entry(stick, depths, entry, is_resting && is_resting[(int)entry->interface], told);
  }
}
