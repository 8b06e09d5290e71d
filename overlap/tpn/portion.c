// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/portion.h"

#include <math.h>
#include <string.h>

#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/coplanar.h"
#include "overlap/pair/invariant.h"
#include "overlap/pair/simplex.h"
#include "overlap/separation.h"
#include "overlap/tpn/share.h"

enum {
  SIZE = OVERLAP_PAIR_SIZE,
  HALF = SIZE / 2,
  SQUARE = SIZE * SIZE,
  ROWS = OVERLAP_TPN_ROWS,
  BENT = OVERLAP_TPN_BENT_ROWS,
  TANGENTS = OVERLAP_TPN_TANGENTS,
  QUANTITIES = OVERLAP_TPN_QUANTITIES
};

// The network's outputs, of which only those asked for are computed.
enum { STATUS = 1 << 0, VOLUME = 1 << 1 };

// A pair that the network is asked.
typedef struct Slot {
  int pair; // of the portion
  OverlapTpnNormalised normalised[OVERLAP_TPN_MAX_ORDERS];
  OverlapTpnInputs inputs;
  double inside_gradient[OVERLAP_TPN_MAX_ORDERS][SIZE]; // by the normalised pair
  double exact_gradient[SIZE], clip_gradient[SIZE];
  double partials[QUANTITIES]; // ∂V by all that it is made of
} Slot;

// A portion's memory; in the workspace.
typedef struct Portion {
  const OverlapTpnModel *overlap;
  const OverlapBatch *batch;
  int slot_count;
  Slot slots[ROWS];
  double closed[ROWS], closed_gradient[ROWS * SIZE]; // V₀ and its gradient
  unsigned flags[ROWS];
  Status status;
  // With second derivatives:
  double closed_hessian[BENT * SQUARE];
  OverlapTpnJet volumes[BENT];                  // of the slots
  float directions[BENT * TANGENTS * TANGENTS]; // the second tetrahedron's normalised coordinates, one by one
  float rates[BENT * TANGENTS * 2];             // of both outputs along them
  float second[BENT * TANGENTS * TANGENTS];     // of the weighed outputs
} Portion;

size_t overlap_tpn_portion_size(void) {
  return sizeof(Portion);
}

bool overlap_tpn_portion_has_hessian(const OverlapTpnNetwork *model) {
  const NetShape *shape = &model->network.plan->shape;
  return shape->activation == NET_SILU && shape->pool == NET_SUM && model->kind == OVERLAP_TPN_NORMALISE_UNIT;
}

// Where pair i's results go; NULL where they are not wanted.
static double *gradient_of(const OverlapBatch *batch, int i) {
  return batch->gradient ? batch->gradient + (size_t)i * SIZE : NULL;
}

static double *hessian_of(const OverlapBatch *batch, int i) {
  return batch->hessian ? batch->hessian + (size_t)i * SQUARE : NULL;
}

static const double *pair_of(const Portion *portion, const Slot *slot) {
  return portion->batch->pairs + (size_t)slot->pair * SIZE;
}

static bool wants_slopes(const OverlapBatch *batch) {
  return batch->gradient || batch->hessian;
}

// ---- Before the network.

static Status answer_by_exact(const OverlapBatch *batch, int i) {
  unsigned flags;
  double volume;
  const double *pair = batch->pairs + (size_t)i * SIZE;
  if (batch->hessian)
    TRY(overlap_clip_ops.eval_pair(
        NULL, pair, &(OverlapAnswer){.volume = &volume, .hessian = hessian_of(batch, i), .flags = &flags}));
  TRY(overlap_exact_ops.eval_pair(
      NULL, pair,
      &(OverlapAnswer){.volume = batch->volume + i, .gradient = gradient_of(batch, i), .flags = &flags}));
  if (batch->flags) batch->flags[i] = flags | OVERLAP_FALLBACK;
  return STATUS_OK;
}

static void answer_disjoint(const OverlapBatch *batch, int i, unsigned flags) {
  batch->volume[i] = 0;
  if (batch->gradient) memset(gradient_of(batch, i), 0, SIZE * sizeof(double));
  if (batch->hessian) memset(hessian_of(batch, i), 0, SQUARE * sizeof(double));
  if (batch->flags) batch->flags[i] = flags;
}

// V₀ of all pairs, or which pairs are disjoint.
static Status find_disjoint(Portion *portion) {
  const OverlapBatch *batch = portion->batch;
  memset(portion->flags, 0, sizeof portion->flags);
  if (portion->overlap->ghosts == OVERLAP_GHOSTS_CUT)
    for (int i = 0; i < batch->pair_count; i++)
      if (overlap_separation_pair(batch->pairs + (ptrdiff_t)i * SIZE, 0) >= 0)
        portion->flags[i] = OVERLAP_DISJOINT;
  if (portion->overlap->ghosts != OVERLAP_GHOSTS_FADE) return STATUS_OK;
  OverlapBatch closed = {.pair_count = batch->pair_count,
                         .pairs = batch->pairs,
                         .volume = portion->closed,
                         .gradient = wants_slopes(batch) ? portion->closed_gradient : NULL,
                         .hessian = batch->hessian ? portion->closed_hessian : NULL,
                         .flags = portion->flags};
  return overlap_geo_eval(&portion->overlap->closed, &closed);
}

// What clipping has to say of a pair: c and V_c. The closed form has told which pairs have faces nearly in
// one plane, where it was asked.
static Status find_clip_share(const Portion *portion, Slot *slot) {
  const OverlapTpnModel *overlap = portion->overlap;
  const double *pair = pair_of(portion, slot);
  slot->inputs.of[OVERLAP_TPN_PLANE] = 0;
  if (!overlap->turns_to_clip) return STATUS_OK;
  bool is_known = overlap->ghosts == OVERLAP_GHOSTS_FADE;
  if (is_known && !(portion->flags[slot->pair] & OVERLAP_BLENDED)) return STATUS_OK;
  OverlapGeoFrame frame;
  OverlapGeoCoplanar coplanar;
  if (overlap_geo_frame(&frame, pair) != OVERLAP_GEO_INSIDE) return STATUS_OK;
  overlap_geo_coplanar_find(&frame.projector, &coplanar);
  slot->inputs.of[OVERLAP_TPN_PLANE] = coplanar.share;
  if (!(coplanar.share > 0)) return STATUS_OK;
  unsigned flags;
  return overlap_clip_ops.eval_pair(
      NULL, pair,
      &(OverlapAnswer){.volume = &slot->inputs.of[OVERLAP_TPN_CLIP],
                       .gradient = wants_slopes(portion->batch) ? slot->clip_gradient : NULL,
                       .flags = &flags});
}

// Normalises the pair in all orders; false: the network cannot be asked.
static bool prepare(const Portion *portion, Slot *slot) {
  const OverlapTpnModel *overlap = portion->overlap;
  const OverlapTpnRule *rule = &overlap->rule;
  double orders[2][SIZE];
  memcpy(orders[0], pair_of(portion, slot), sizeof orders[0]);
  overlap_ops_swap(orders[0], orders[1]);
  for (int o = 0; o < rule->order_count; o++) {
    OverlapTpnNormalised *normalised = &slot->normalised[o];
    if (!overlap_tpn_normalise(overlap->model.kind, orders[o], normalised)) return false;
    bool wants_slope = rule->keeps_to_range && wants_slopes(portion->batch);
    slot->inputs.of[OVERLAP_TPN_FACTOR + o] = normalised->factor;
    slot->inputs.of[OVERLAP_TPN_INSIDE + o] =
        rule->has_range ? overlap_range_weight(&rule->range, normalised->pair,
                                               wants_slope ? slot->inside_gradient[o] : NULL, NULL)
                        : 1;
  }
  for (int t = 0; t < 2 && rule->rounds; t++)
    slot->inputs.of[OVERLAP_TPN_SIZE + t] = overlap_invariant_tet_volume(orders[0] + HALF * t);
  if (overlap->ghosts == OVERLAP_GHOSTS_FADE)
    slot->inputs.of[OVERLAP_TPN_SHARE] = overlap_tpn_share(orders[0], portion->closed[slot->pair]);
  return true;
}

static unsigned beyond_flag(const OverlapTpnRule *rule, const Slot *slot) {
  bool is_beyond = false;
  for (int o = 0; o < rule->order_count; o++) is_beyond |= !(slot->inputs.of[OVERLAP_TPN_INSIDE + o] >= 1);
  return is_beyond ? OVERLAP_BEYOND : 0;
}

// Gives the pair a slot, or has it answered by the exact model.
static Status add_pair(Portion *portion, OverlapTpnWorkspace *workspace, int i) {
  const OverlapBatch *batch = portion->batch;
  const OverlapTpnRule *rule = &portion->overlap->rule;
  Slot *slot = &portion->slots[portion->slot_count];
  slot->pair = i;
  bool is_prepared = prepare(portion, slot);
  if (!is_prepared || overlap_tpn_blend_is_exact(rule, &slot->inputs)) {
    TRY(answer_by_exact(batch, i));
    if (is_prepared && batch->flags) batch->flags[i] |= beyond_flag(rule, slot);
    return STATUS_OK;
  }
  TRY(find_clip_share(portion, slot));
  for (int o = 0; o < rule->order_count; o++)
    overlap_tpn_network_add_row(&portion->overlap->model, workspace, slot->normalised[o].pair);
  portion->slot_count++;
  return STATUS_OK;
}

static Status add_pairs(Portion *portion, OverlapTpnWorkspace *workspace) {
  const unsigned nothing = OVERLAP_DISJOINT | OVERLAP_FLAT;
  TRY(find_disjoint(portion));
  portion->slot_count = 0;
  for (int i = 0; i < portion->batch->pair_count; i++) {
    if (portion->flags[i] & nothing)
      answer_disjoint(portion->batch, i, portion->flags[i]);
    else
      TRY(add_pair(portion, workspace, i));
  }
  return STATUS_OK;
}

// ---- After it.

static unsigned flags_of(const Portion *portion, const Slot *slot, double weight, double volume) {
  const OverlapTpnRule *rule = &portion->overlap->rule;
  double left = weight * (1 - slot->inputs.of[OVERLAP_TPN_PLANE]);
  unsigned flags = portion->flags[slot->pair] & OVERLAP_ENCLOSED;
  if (left > 0) flags |= OVERLAP_NET;
  if (left < 1) flags |= left > 0 ? OVERLAP_BLENDED : OVERLAP_FALLBACK;
  if (volume == 0) flags |= OVERLAP_DISJOINT;
  if (overlap_tpn_blend_is_beyond(rule, &slot->inputs)) flags |= OVERLAP_BEYOND;
  return flags | beyond_flag(rule, slot);
}

// V of a pair with a slot from the network's outputs y, with its derivatives by what it is made of.
static Status blend_answer(Portion *portion, Slot *slot, const float *y, int order, OverlapTpnJet *volume) {
  const OverlapBatch *batch = portion->batch;
  const OverlapTpnRule *rule = &portion->overlap->rule;
  for (int o = 0; o < rule->order_count; o++) {
    slot->inputs.of[OVERLAP_TPN_LOGIT + o] = (double)y[2 * o];
    slot->inputs.of[OVERLAP_TPN_VOLUME + o] = (double)y[2 * o + 1];
  }
  double weight = overlap_tpn_blend_weight(rule, &slot->inputs);
  unsigned flags;
  if (weight < 1)
    TRY(overlap_exact_ops.eval_pair(NULL, pair_of(portion, slot),
                                    &(OverlapAnswer){.volume = &slot->inputs.of[OVERLAP_TPN_EXACT],
                                                     .gradient = order > 0 ? slot->exact_gradient : NULL,
                                                     .flags = &flags}));
  overlap_tpn_blend_eval(rule, &slot->inputs, order, volume);
  batch->volume[slot->pair] = volume->value;
  if (order > 0) memcpy(slot->partials, volume->first, sizeof slot->partials);
  if (batch->flags) batch->flags[slot->pair] = flags_of(portion, slot, weight, volume->value);
  return STATUS_OK;
}

static int order_count(const Portion *portion) {
  return portion->overlap->rule.order_count;
}

// What the network's outputs are weighed with, for the backward pass. The normalisation multiplies by its
// factor later.
static void weigh(void *self, const float *y, float *c) {
  Portion *portion = self;
  int n = order_count(portion);
  for (int s = 0; s < portion->slot_count && !portion->status; s++) {
    Slot *slot = &portion->slots[s];
    OverlapTpnJet volume;
    portion->status = blend_answer(portion, slot, y + 2 * (ptrdiff_t)n * s, 1, &volume);
    for (int o = 0; o < n; o++) {
      float *weights = c + 2 * ((ptrdiff_t)n * s + o);
      weights[0] = (float)(slot->partials[OVERLAP_TPN_LOGIT + o] / slot->normalised[o].factor);
      weights[1] = (float)(slot->partials[OVERLAP_TPN_VOLUME + o] / slot->normalised[o].factor);
    }
  }
}

static void add_order(const Portion *portion, const Slot *slot, int o, const OverlapTpnWorkspace *workspace,
                      int row, double *gradient) {
  double inner[SIZE], pulled[SIZE];
  const OverlapTpnNormalised *normalised = &slot->normalised[o];
  double by_range = slot->partials[OVERLAP_TPN_INSIDE + o] / normalised->factor;
  overlap_tpn_network_pull(&portion->overlap->model, workspace, row, inner);
  for (int i = 0; i < SIZE && by_range != 0; i++) inner[i] += by_range * slot->inside_gradient[o][i];
  overlap_tpn_normalise_pull(normalised, slot->partials[OVERLAP_TPN_FACTOR + o], inner, pulled);
  for (int i = 0; i < SIZE; i++) gradient[i] += pulled[o ? (i + HALF) % SIZE : i];
}

// ∇c and, unless NULL, ∇²c.
static void pull_plane(const double pair[SIZE], double gradient[SIZE], double *hessian) {
  OverlapGeoFrame frame;
  OverlapGeoCoplanar coplanar;
  overlap_geo_frame(&frame, pair);
  overlap_geo_coplanar_find(&frame.projector, &coplanar);
  overlap_geo_coplanar_pull(&frame, &coplanar, gradient, hessian);
}

static void add(double factor, const double part[SIZE], double gradient[SIZE]) {
  for (int i = 0; i < SIZE; i++) gradient[i] += factor * part[i];
}

// ∇ of the volume of tetrahedron t.
static void size_slope(const Slot *slot, const double pair[SIZE], int t, double gradient[SIZE]) {
  memset(gradient, 0, SIZE * sizeof *gradient);
  overlap_simplex_volume(pair + HALF * t, gradient + HALF * t);
  for (int i = 0; i < HALF; i++) gradient[HALF * t + i] *= slot->inputs.of[OVERLAP_TPN_SIZE + t];
}

static void differentiate(const Portion *portion, const Slot *slot, const OverlapTpnWorkspace *workspace,
                          int row) {
  const double *pair = pair_of(portion, slot), *by = slot->partials;
  double *gradient = gradient_of(portion->batch, slot->pair), part[SIZE];
  memset(gradient, 0, SIZE * sizeof *gradient);
  for (int o = 0; o < order_count(portion); o++) add_order(portion, slot, o, workspace, row + o, gradient);
  if (by[OVERLAP_TPN_SHARE] != 0) {
    overlap_tpn_share_bend(pair, portion->closed[slot->pair],
                           portion->closed_gradient + SIZE * (ptrdiff_t)slot->pair, NULL, part, NULL);
    add(by[OVERLAP_TPN_SHARE], part, gradient);
  }
  for (int t = 0; t < 2; t++)
    if (by[OVERLAP_TPN_SIZE + t] != 0) {
      size_slope(slot, pair, t, part);
      add(by[OVERLAP_TPN_SIZE + t], part, gradient);
    }
  if (by[OVERLAP_TPN_EXACT] != 0) add(by[OVERLAP_TPN_EXACT], slot->exact_gradient, gradient);
  if (!(slot->inputs.of[OVERLAP_TPN_PLANE] > 0)) return;
  pull_plane(pair, part, NULL);
  add(by[OVERLAP_TPN_PLANE], part, gradient);
  add(by[OVERLAP_TPN_CLIP], slot->clip_gradient, gradient);
}

// ---- Second derivatives: ∇²V = Σ_i V_i ∇²s_i + Σ_ij V_ij ∇s_i ∇s_jᵀ, s_i what V is made of.

// A slot's slopes ∇s_i, and the first sum.
typedef struct Chain {
  bool is_met[QUANTITIES]; // those that V depends on here
  double slope[QUANTITIES][SIZE];
  double sum[SQUARE];
} Chain;

static double *meet(Chain *chain, int quantity) {
  chain->is_met[quantity] = true;
  return chain->slope[quantity];
}

static void add_curvature(Chain *chain, double factor, const double hessian[SQUARE], bool is_swapped) {
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++)
      chain->sum[SIZE * i + j] +=
          factor *
          (is_swapped ? hessian[SIZE * ((i + HALF) % SIZE) + (j + HALF) % SIZE] : hessian[SIZE * i + j]);
}

static void keep_slope(Chain *chain, int quantity, const double gradient[SIZE], bool is_swapped) {
  double *slope = meet(chain, quantity);
  for (int i = 0; i < SIZE; i++) slope[i] = gradient[is_swapped ? (i + HALF) % SIZE : i];
}

// Both outputs of order o: their slopes from the rates along the second tetrahedron's normalised coordinates,
// the bend of both as they are weighed.
static void chain_outputs(Chain *chain, const Slot *slot, int o, const float *rates, const float *second) {
  double inner[SIZE] = {0}, bend[TANGENTS * TANGENTS], gradient[SIZE], hessian[SQUARE];
  const OverlapTpnNormalised *normalised = &slot->normalised[o];
  for (int which = 0; which < 2; which++) {
    OverlapTpnNormalised plain = *normalised;
    plain.factor = 1;
    for (int t = 0; t < TANGENTS; t++) inner[HALF + t] = (double)rates[2 * t + which];
    overlap_tpn_normalise_pull(&plain, 0, inner, gradient);
    keep_slope(chain, (which ? OVERLAP_TPN_VOLUME : OVERLAP_TPN_LOGIT) + o, gradient, o);
  }
  for (int t = 0; t < TANGENTS; t++)
    inner[HALF + t] = slot->partials[OVERLAP_TPN_LOGIT + o] * (double)rates[2 * t] +
                      slot->partials[OVERLAP_TPN_VOLUME + o] * (double)rates[2 * t + 1];
  for (int e = 0; e < TANGENTS * TANGENTS; e++) bend[e] = (double)second[e];
  overlap_tpn_normalise_bend_unit(normalised, inner, bend, gradient, hessian);
  add_curvature(chain, 1, hessian, o);
}

// The factor of order o: |det E|, E of the first tetrahedron.
static void chain_factor(Chain *chain, const Slot *slot, const double pair[SIZE], int o) {
  double lambda[SIZE] = {0}, hessian[SQUARE] = {0}, factor = slot->normalised[o].factor;
  overlap_simplex_volume(pair + HALF * o, lambda);
  overlap_simplex_add_outer(lambda, factor, -factor, hessian);
  for (int i = 0; i < HALF; i++) lambda[i] *= factor;
  keep_slope(chain, OVERLAP_TPN_FACTOR + o, lambda, o);
  add_curvature(chain, slot->partials[OVERLAP_TPN_FACTOR + o], hessian, o);
}

static void chain_size(Chain *chain, const Slot *slot, const double pair[SIZE], int t) {
  double lambda[HALF], hessian[SQUARE] = {0}, volume = slot->inputs.of[OVERLAP_TPN_SIZE + t];
  overlap_simplex_volume(pair + HALF * t, lambda);
  overlap_simplex_add_outer(lambda, volume, -volume, hessian + (SIZE + 1) * HALF * t);
  size_slope(slot, pair, t, meet(chain, OVERLAP_TPN_SIZE + t));
  add_curvature(chain, slot->partials[OVERLAP_TPN_SIZE + t], hessian, false);
}

static void chain_range(Chain *chain, const OverlapTpnRule *rule, const Slot *slot, int o) {
  double inner[SIZE], whole[SQUARE], bend[TANGENTS * TANGENTS], gradient[SIZE], hessian[SQUARE];
  overlap_range_weight(&rule->range, slot->normalised[o].pair, inner, whole);
  for (int i = 0; i < HALF; i++)
    for (int j = 0; j < HALF; j++) bend[HALF * i + j] = whole[SIZE * (HALF + i) + HALF + j];
  overlap_tpn_normalise_bend_unit(&slot->normalised[o], inner, bend, gradient, hessian);
  keep_slope(chain, OVERLAP_TPN_INSIDE + o, gradient, o);
  add_curvature(chain, slot->partials[OVERLAP_TPN_INSIDE + o], hessian, o);
}

static void chain_share(Chain *chain, const Portion *portion, const Slot *slot) {
  double hessian[SQUARE];
  ptrdiff_t at = slot->pair;
  overlap_tpn_share_bend(pair_of(portion, slot), portion->closed[at], portion->closed_gradient + SIZE * at,
                         portion->closed_hessian + SQUARE * at, meet(chain, OVERLAP_TPN_SHARE), hessian);
  add_curvature(chain, slot->partials[OVERLAP_TPN_SHARE], hessian, false);
}

static Status chain_careful(Chain *chain, const Slot *slot, const double pair[SIZE]) {
  double volume, hessian[SQUARE];
  unsigned flags;
  bool is_near = slot->inputs.of[OVERLAP_TPN_PLANE] > 0;
  if (is_near) {
    pull_plane(pair, meet(chain, OVERLAP_TPN_PLANE), hessian);
    add_curvature(chain, slot->partials[OVERLAP_TPN_PLANE], hessian, false);
    keep_slope(chain, OVERLAP_TPN_CLIP, slot->clip_gradient, false);
  }
  if (slot->partials[OVERLAP_TPN_EXACT] != 0)
    keep_slope(chain, OVERLAP_TPN_EXACT, slot->exact_gradient, false);
  double factor = (is_near ? slot->partials[OVERLAP_TPN_CLIP] : 0) + slot->partials[OVERLAP_TPN_EXACT];
  if (factor == 0) return STATUS_OK;
  TRY(overlap_clip_ops.eval_pair(NULL, pair,
                                 &(OverlapAnswer){.volume = &volume, .hessian = hessian, .flags = &flags}));
  add_curvature(chain, factor, hessian, false);
  return STATUS_OK;
}

// hessian = sum + Σ V_ij ∇s_i ∇s_jᵀ, gradient = Σ V_i ∇s_i
static void finish_chain(const Chain *chain, const OverlapTpnJet *volume, double *gradient, double *hessian) {
  if (gradient) memset(gradient, 0, SIZE * sizeof *gradient);
  memcpy(hessian, chain->sum, sizeof chain->sum);
  for (int i = 0; i < QUANTITIES; i++) {
    if (!chain->is_met[i]) continue;
    double row[SIZE] = {0};
    if (gradient) add(volume->first[i], chain->slope[i], gradient);
    for (int j = 0; j < QUANTITIES; j++)
      if (chain->is_met[j] && volume->second[i][j] != 0) add(volume->second[i][j], chain->slope[j], row);
    for (int k = 0; k < SIZE; k++) add(chain->slope[i][k], row, hessian + SIZE * k);
  }
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < i; j++)
      hessian[SIZE * i + j] = hessian[SIZE * j + i] = (hessian[SIZE * i + j] + hessian[SIZE * j + i]) / 2;
}

static Status write_hessian(const Portion *portion, int s) {
  const Slot *slot = &portion->slots[s];
  const OverlapTpnRule *rule = &portion->overlap->rule;
  Chain chain = {.is_met = {false}};
  for (int o = 0; o < rule->order_count; o++) {
    ptrdiff_t row = (ptrdiff_t)rule->order_count * s + o;
    chain_outputs(&chain, slot, o, portion->rates + 2 * TANGENTS * row,
                  portion->second + TANGENTS * TANGENTS * row);
    chain_factor(&chain, slot, pair_of(portion, slot), o);
    if (rule->keeps_to_range && slot->inputs.of[OVERLAP_TPN_INSIDE + o] < 1)
      chain_range(&chain, rule, slot, o);
  }
  for (int t = 0; t < 2; t++)
    if (slot->partials[OVERLAP_TPN_SIZE + t] != 0) chain_size(&chain, slot, pair_of(portion, slot), t);
  if (slot->partials[OVERLAP_TPN_SHARE] != 0) chain_share(&chain, portion, slot);
  TRY(chain_careful(&chain, slot, pair_of(portion, slot)));
  finish_chain(&chain, &portion->volumes[s], gradient_of(portion->batch, slot->pair),
               hessian_of(portion->batch, slot->pair));
  return STATUS_OK;
}

static void set_directions(Portion *portion, int row_count) {
  memset(portion->directions, 0, sizeof portion->directions);
  for (ptrdiff_t row = 0; row < row_count; row++)
    for (int t = 0; t < TANGENTS; t++) portion->directions[(row * TANGENTS + t) * TANGENTS + t] = 1;
}

static Status eval_bent(Portion *portion, OverlapTpnWorkspace *workspace) {
  int n = order_count(portion);
  const OverlapTpnNetwork *model = &portion->overlap->model;
  workspace->work.outputs = STATUS | VOLUME;
  net_forward_eval_f32(&workspace->work, &model->network, workspace->row_count, workspace->x, workspace->y);
  for (int s = 0; s < portion->slot_count; s++) {
    Slot *slot = &portion->slots[s];
    TRY(blend_answer(portion, slot, workspace->y + 2 * (ptrdiff_t)n * s, 2, &portion->volumes[s]));
    for (int o = 0; o < n; o++) {
      float *weights = workspace->c + 2 * ((ptrdiff_t)n * s + o);
      weights[0] = (float)slot->partials[OVERLAP_TPN_LOGIT + o];
      weights[1] = (float)slot->partials[OVERLAP_TPN_VOLUME + o];
    }
  }
  set_directions(portion, workspace->row_count);
  net_tangent_second_f32(&workspace->work, &model->network, workspace->row_count, TANGENTS, workspace->x,
                         portion->directions, workspace->c, NULL, portion->rates, NULL, portion->second);
  for (int s = 0; s < portion->slot_count; s++) TRY(write_hessian(portion, s));
  return STATUS_OK;
}

static Status eval_volumes(Portion *portion, OverlapTpnWorkspace *workspace) {
  int n = order_count(portion);
  OverlapTpnJet volume;
  net_forward_eval_f32(&workspace->work, &portion->overlap->model.network, workspace->row_count, workspace->x,
                       workspace->y);
  for (int s = 0; s < portion->slot_count; s++)
    TRY(blend_answer(portion, &portion->slots[s], workspace->y + 2 * (ptrdiff_t)n * s, 0, &volume));
  return STATUS_OK;
}

Status overlap_tpn_portion_eval(const OverlapTpnModel *overlap, const OverlapBatch *batch,
                                OverlapTpnWorkspace *workspace) {
  Portion *portion = workspace->more;
  portion->overlap = overlap;
  portion->batch = batch;
  portion->status = STATUS_OK;
  TRY(add_pairs(portion, workspace));
  if (portion->slot_count == 0) return STATUS_OK;
  if (batch->hessian) return eval_bent(portion, workspace);
  int n = order_count(portion);
  workspace->work.outputs = overlap->rule.gates || overlap->rule.is_hybrid ? STATUS | VOLUME : VOLUME;
  if (!batch->gradient) return eval_volumes(portion, workspace);
  net_forward_pull_f32(&workspace->work, &overlap->model.network, workspace->row_count, workspace->x, weigh,
                       portion, workspace->y, workspace->c, workspace->gx);
  for (int s = 0; s < portion->slot_count && !portion->status; s++)
    differentiate(portion, &portion->slots[s], workspace, n * s);
  return portion->status;
}
