// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/net_overlap.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/exact.h"
#include "contact/geo.h"
#include "contact/net_blend.h"
#include "contact/separation.h"
#include "contact/weights.h"

enum { SIZE = CONTACT_PAIR_SIZE, ROWS = CONTACT_NET_ROWS };

// The network's outputs, of which only those asked for are computed.
enum { STATUS = 1 << 0, VOLUME = 1 << 1 };

typedef struct NetOverlap {
  ContactNetModel model;
  ContactNetRule rule;
  ContactNetGhosts ghosts;
  ContactGeoModel closed; // the closed form, where it fades or blends
} NetOverlap;

// A pair that the network is asked.
typedef struct Seat {
  int pair; // of the portion
  double share, share_scale;
  ContactNormalised normalised[CONTACT_NET_MAX_ORDERS];
  double inside[CONTACT_NET_MAX_ORDERS], inside_gradient[CONTACT_NET_MAX_ORDERS][SIZE];
  ContactNetPrior prior;
  ContactNetBlend blend;
  double exact_gradient[SIZE];
} Seat;

// A portion's memory; lies on the desk.
typedef struct Papers {
  const NetOverlap *overlap;
  const ContactOverlapBatch *batch;
  int seat_count;
  Seat seats[ROWS];
  double closed[ROWS], closed_gradient[ROWS * SIZE]; // V₀ and its gradient
  unsigned flags[ROWS];
  Status status;
} Papers;

ContactNetOptions contact_net_options_default(void) {
  return (ContactNetOptions){.touch = 0.02, .deep = 0.3, .confidence = 0.95};
}

void contact_net_overlap_destroy(void *self) {
  NetOverlap *overlap = self;
  if (!overlap) return;
  contact_net_model_destroy(&overlap->model);
  memory_free(overlap);
}

// Fills in what the options leave to the model.
static ContactNetOptions resolve(const ContactNetOptions *given, const ContactNetOptions *own) {
  ContactNetOptions options = given ? *given : contact_net_options_default();
  if (options.ghosts == CONTACT_NET_GHOSTS_AUTO) options.ghosts = own->ghosts;
  if (options.gate == CONTACT_NET_GATE_AUTO) options.gate = own->gate;
  if (options.orders == CONTACT_NET_ORDERS_AUTO) options.orders = own->orders;
  if (options.beyond == CONTACT_NET_BEYOND_AUTO) options.beyond = own->beyond;
  return options;
}

static Status set_rule(NetOverlap *overlap, const ContactNetOptions *options, bool is_hybrid,
                       const char *path) {
  const ContactNetModel *model = &overlap->model;
  overlap->ghosts = is_hybrid ? CONTACT_NET_GHOSTS_FADE : options->ghosts;
  overlap->rule = (ContactNetRule){.fades = !is_hybrid && options->ghosts == CONTACT_NET_GHOSTS_FADE,
                                   .gates = options->gate == CONTACT_NET_GATE_STATUS,
                                   .rounds = is_hybrid || options->gate == CONTACT_NET_GATE_STATUS,
                                   .is_hybrid = is_hybrid,
                                   .keeps_to_range = options->beyond == CONTACT_NET_BEYOND_EXACT,
                                   .has_range = model->has_range,
                                   .range = model->range,
                                   .order_count = options->orders == CONTACT_NET_ORDERS_BOTH ? 2 : 1,
                                   .touch = options->touch,
                                   .deep = options->deep,
                                   .logit = log(options->confidence / (1 - options->confidence)),
                                   .scale = model->scale};
  if (overlap->rule.keeps_to_range && !model->has_range)
    return status_fail(
        STATUS_INPUT,
        "%s: does not say which pairs it was trained on (range: '%s'), so none can be told to be "
        "beyond; `tetlap weights --range` writes it into the file",
        path, model->card.range);
  return contact_geo_model_create(&overlap->closed, NULL);
}

static Status create(void **self, const char *path, const ContactNetOptions *given,
                     const ContactNetOptions *own, bool is_hybrid) {
  ContactNetOptions options = resolve(given, own);
  NetOverlap *overlap = memory_zeroed(1, sizeof *overlap);
  if (!overlap) return status_no_memory("an overlap model");
  Status status = contact_net_model_create(&overlap->model, path, sizeof(Papers));
  if (!status) status = set_rule(overlap, &options, is_hybrid, path);
  if (!status)
    *self = overlap;
  else
    contact_net_overlap_destroy(overlap);
  return status;
}

// ---- Before the network.

static Status give_exact(const ContactOverlapBatch *batch, int i) {
  unsigned flags;
  size_t at = (size_t)i * SIZE;
  TRY(contact_overlap_exact.eval_pair(NULL, batch->pairs + at, batch->volume + i,
                                      batch->gradient ? batch->gradient + at : NULL, NULL, &flags));
  if (batch->flags) batch->flags[i] = flags | CONTACT_OVERLAP_FALLBACK;
  return STATUS_OK;
}

static void give_nothing(const ContactOverlapBatch *batch, int i, unsigned flags) {
  batch->volume[i] = 0;
  if (batch->gradient) memset(batch->gradient + (size_t)i * SIZE, 0, SIZE * sizeof(double));
  if (batch->flags) batch->flags[i] = flags;
}

// V₀ of all pairs, or who is disjoint.
static Status sift(Papers *papers) {
  const ContactOverlapBatch *batch = papers->batch;
  memset(papers->flags, 0, sizeof papers->flags);
  if (papers->overlap->ghosts == CONTACT_NET_GHOSTS_CUT)
    for (int i = 0; i < batch->pair_count; i++)
      if (contact_separation_pair(batch->pairs + (ptrdiff_t)i * SIZE, 0) >= 0)
        papers->flags[i] = CONTACT_OVERLAP_DISJOINT;
  if (papers->overlap->ghosts != CONTACT_NET_GHOSTS_FADE) return STATUS_OK;
  ContactOverlapBatch closed = {.pair_count = batch->pair_count,
                                .pairs = batch->pairs,
                                .volume = papers->closed,
                                .gradient = batch->gradient ? papers->closed_gradient : NULL,
                                .flags = papers->flags};
  return contact_geo_eval(&papers->overlap->closed, &closed);
}

// The derivatives of a tetrahedron's unsigned volume by vertex v, and the volume.
static double volume_of(const double tet[12], Vec3 slope[4]) {
  Vec3 origin = vec3_at(tet), edge[3];
  for (int k = 0; k < 3; k++) edge[k] = vec3_sub(vec3_at(tet + 3 + 3 * k), origin);
  double six = vec3_dot(edge[0], vec3_cross(edge[1], edge[2])), sign = six > 0 ? 1.0 / 6 : -1.0 / 6;
  slope[0] = (Vec3){0, 0, 0};
  for (int k = 0; k < 3; k++) {
    slope[k + 1] = vec3_scale(sign, vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3]));
    slope[0] = vec3_sub(slope[0], slope[k + 1]);
  }
  return fabs(six) / 6;
}

// q = V₀ (1/V_A + 1/V_B)
static void find_share(const Papers *papers, Seat *seat) {
  const double *pair = papers->batch->pairs + (ptrdiff_t)seat->pair * SIZE;
  Vec3 slope[4];
  seat->share_scale = 1 / volume_of(pair, slope) + 1 / volume_of(pair + 12, slope);
  seat->share = papers->closed[seat->pair] * seat->share_scale;
}

// gradient += scale · ∇q
static void add_share_gradient(const Papers *papers, const Seat *seat, double scale, double *gradient) {
  const double *pair = papers->batch->pairs + (ptrdiff_t)seat->pair * SIZE;
  const double *closed = papers->closed_gradient + (ptrdiff_t)seat->pair * SIZE;
  for (int i = 0; i < SIZE; i++) gradient[i] += scale * seat->share_scale * closed[i];
  for (int t = 0; t < 2; t++) {
    Vec3 slope[4];
    double volume = volume_of(pair + 12 * t, slope);
    double factor = -scale * papers->closed[seat->pair] / (volume * volume);
    for (int v = 0; v < 4; v++) vec3_accumulate(gradient + 12 * t + 3 * v, vec3_scale(factor, slope[v]));
  }
}

static void swap_order(const double pair[SIZE], double swapped[SIZE]) {
  memcpy(swapped, pair + 12, 12 * sizeof(double));
  memcpy(swapped + 12, pair, 12 * sizeof(double));
}

// Normalises the pair in all orders; false: the network cannot be asked.
static bool prepare(const Papers *papers, Seat *seat) {
  const NetOverlap *overlap = papers->overlap;
  const ContactNetRule *rule = &overlap->rule;
  const double *pair = papers->batch->pairs + (ptrdiff_t)seat->pair * SIZE;
  double swapped[SIZE];
  swap_order(pair, swapped);
  for (int o = 0; o < rule->order_count; o++) {
    ContactNormalised *normalised = &seat->normalised[o];
    if (!contact_normalise(overlap->model.kind, o ? swapped : pair, normalised)) return false;
    double *gradient = rule->keeps_to_range && papers->batch->gradient ? seat->inside_gradient[o] : NULL;
    seat->inside[o] =
        rule->has_range ? contact_net_range_weight(&rule->range, normalised->pair, gradient) : 1;
  }
  if (overlap->ghosts == CONTACT_NET_GHOSTS_FADE) find_share(papers, seat);
  seat->prior = contact_net_blend_prior(rule, seat->share, seat->inside);
  return true;
}

static unsigned beyond_flag(const ContactNetRule *rule, const Seat *seat) {
  bool is_beyond = seat->blend.is_beyond;
  for (int o = 0; o < rule->order_count; o++) is_beyond |= !(seat->inside[o] >= 1);
  return is_beyond ? CONTACT_OVERLAP_BEYOND : 0;
}

// Answers what needs no network and gives the others a seat.
static Status seat_pairs(Papers *papers, ContactNetDesk *desk) {
  const ContactOverlapBatch *batch = papers->batch;
  const ContactNetRule *rule = &papers->overlap->rule;
  const unsigned nothing = CONTACT_OVERLAP_DISJOINT | CONTACT_OVERLAP_FLAT;
  TRY(sift(papers));
  papers->seat_count = 0;
  for (int i = 0; i < batch->pair_count; i++) {
    Seat *seat = &papers->seats[papers->seat_count];
    seat->pair = i;
    seat->blend.is_beyond = false;
    if (papers->flags[i] & nothing) {
      give_nothing(batch, i, papers->flags[i]);
      continue;
    }
    bool is_prepared = prepare(papers, seat);
    if (is_prepared && !contact_net_blend_is_exact(rule, &seat->prior)) {
      for (int o = 0; o < rule->order_count; o++)
        contact_net_model_lay(&papers->overlap->model, desk, seat->normalised[o].pair);
      papers->seat_count++;
      continue;
    }
    TRY(give_exact(batch, i));
    if (is_prepared && batch->flags) batch->flags[i] |= beyond_flag(rule, seat);
  }
  return STATUS_OK;
}

// ---- After it.

static ContactNetTold told_of(const ContactNetRule *rule, const Seat *seat, const float *y) {
  ContactNetTold told;
  for (int o = 0; o < rule->order_count; o++) {
    told.logit[o] = (double)y[2 * o];
    told.volume[o] = (double)y[2 * o + 1];
    told.factor[o] = seat->normalised[o].factor;
  }
  return told;
}

// V of a seated pair, and what its derivatives need.
static Status settle(Papers *papers, Seat *seat, const float *y) {
  const ContactOverlapBatch *batch = papers->batch;
  const ContactNetRule *rule = &papers->overlap->rule;
  ContactNetTold told = told_of(rule, seat, y);
  double exact = 0, weight = contact_net_blend_weigh(rule, &seat->prior, &told).weight;
  unsigned flags = papers->flags[seat->pair] & CONTACT_OVERLAP_ENCLOSED, exact_flags;
  if (weight < 1)
    TRY(contact_overlap_exact.eval_pair(NULL, batch->pairs + (ptrdiff_t)seat->pair * SIZE, &exact,
                                        batch->gradient ? seat->exact_gradient : NULL, NULL, &exact_flags));
  double volume = contact_net_blend_settle(rule, &seat->prior, &told, exact, &seat->blend);
  batch->volume[seat->pair] = volume;
  if (weight > 0) flags |= CONTACT_OVERLAP_NET;
  if (weight < 1) flags |= weight > 0 ? CONTACT_OVERLAP_BLENDED : CONTACT_OVERLAP_FALLBACK;
  if (volume == 0) flags |= CONTACT_OVERLAP_DISJOINT;
  if (batch->flags) batch->flags[seat->pair] = flags | beyond_flag(rule, seat);
  return STATUS_OK;
}

// What the network's outputs are weighed with, for the backward pass. The normalisation multiplies by its
// factor later.
static void weigh(void *self, const float *y, float *c) {
  Papers *papers = self;
  int n = papers->overlap->rule.order_count;
  for (int s = 0; s < papers->seat_count && !papers->status; s++) {
    Seat *seat = &papers->seats[s];
    papers->status = settle(papers, seat, y + 2 * (ptrdiff_t)n * s);
    for (int o = 0; o < n; o++) {
      float *weights = c + 2 * ((ptrdiff_t)n * s + o);
      weights[0] = (float)(seat->blend.by_logit[o] / seat->normalised[o].factor);
      weights[1] = (float)(seat->blend.by_volume[o] / seat->normalised[o].factor);
    }
  }
}

static void add_order(const Papers *papers, const Seat *seat, int o, const ContactNetDesk *desk, int row,
                      double *gradient) {
  double inner[SIZE], pulled[SIZE];
  const ContactNormalised *normalised = &seat->normalised[o];
  double by_range = papers->overlap->rule.keeps_to_range ? seat->blend.by_range[o] / normalised->factor : 0;
  contact_net_model_lift(&papers->overlap->model, desk, row, inner);
  for (int i = 0; i < SIZE && by_range != 0; i++) inner[i] += by_range * seat->inside_gradient[o][i];
  contact_normalise_pull(normalised, seat->blend.inner[o], inner, pulled);
  for (int i = 0; i < SIZE; i++) gradient[i] += pulled[o ? (i + 12) % SIZE : i];
}

static void differentiate(const Papers *papers, const Seat *seat, const ContactNetDesk *desk, int row) {
  double *gradient = papers->batch->gradient + (size_t)seat->pair * SIZE;
  int n = papers->overlap->rule.order_count;
  double left = 1 - seat->blend.weight;
  for (int i = 0; i < SIZE; i++) gradient[i] = left > 0 ? left * seat->exact_gradient[i] : 0;
  if (!(seat->blend.weight > 0)) return;
  for (int o = 0; o < n; o++) add_order(papers, seat, o, desk, row + o, gradient);
  if (seat->blend.by_share != 0) add_share_gradient(papers, seat, seat->blend.by_share, gradient);
}

// At most ROWS / order_count pairs.
static Status eval_seated(const NetOverlap *overlap, const ContactOverlapBatch *batch, ContactNetDesk *desk) {
  Papers *papers = desk->more;
  papers->overlap = overlap;
  papers->batch = batch;
  papers->status = STATUS_OK;
  TRY(seat_pairs(papers, desk));
  if (papers->seat_count == 0) return STATUS_OK;
  int n = overlap->rule.order_count;
  desk->work.outputs = overlap->rule.gates || overlap->rule.is_hybrid ? STATUS | VOLUME : VOLUME;
  if (!batch->gradient) {
    net_forward_eval_f32(&desk->work, &overlap->model.network, desk->row_count, desk->x, desk->y);
    for (int s = 0; s < papers->seat_count; s++)
      TRY(settle(papers, &papers->seats[s], desk->y + 2 * (ptrdiff_t)n * s));
    return STATUS_OK;
  }
  net_forward_pull_f32(&desk->work, &overlap->model.network, desk->row_count, desk->x, weigh, papers, desk->y,
                       desk->c, desk->gx);
  for (int s = 0; s < papers->seat_count && !papers->status; s++)
    differentiate(papers, &papers->seats[s], desk, n * s);
  return papers->status;
}

static Status eval_portion(const NetOverlap *overlap, const ContactOverlapBatch *batch) {
  ContactNetDesk *desk = contact_net_model_take(&overlap->model);
  Status status = eval_seated(overlap, batch, desk);
  contact_net_model_leave(desk);
  return status;
}

static ContactOverlapBatch portion_of(const ContactOverlapBatch *batch, int size, int number) {
  int first = number * size, left = batch->pair_count - first;
  size_t begin = (size_t)first * SIZE;
  return (ContactOverlapBatch){.pair_count = left < size ? left : size,
                               .pairs = batch->pairs + begin,
                               .volume = batch->volume + first,
                               .gradient = batch->gradient ? batch->gradient + begin : NULL,
                               .flags = batch->flags ? batch->flags + first : NULL};
}

Status contact_net_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch) {
  const NetOverlap *overlap = self;
  int size = ROWS / overlap->rule.order_count;
  int count = (batch->pair_count + size - 1) / size, first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (count > 1)
  for (int p = 0; p < count; p++) {
    ContactOverlapBatch portion = portion_of(batch, size, p);
    if (eval_portion(self, &portion) != STATUS_OK && p < first_failed) first_failed = p;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  ContactOverlapBatch portion = portion_of(batch, size, first_failed);
  Status status = eval_portion(self, &portion);
  return status == STATUS_OK
             ? status_fail(STATUS_SOLVER, "pairs from %d on failed once and not again", first_failed * size)
             : status;
}

Status contact_net_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags) {
  (void)hessian;
  ContactOverlapBatch batch = {
      .pair_count = 1, .pairs = pair, .volume = volume, .gradient = gradient, .flags = flags};
  return eval_portion(self, &batch);
}

// Lays the pair's rows if the normalisation takes it.
static bool lay_pair(const NetOverlap *overlap, ContactNetDesk *desk, const double pair[SIZE]) {
  ContactNormalised normalised[CONTACT_NET_MAX_ORDERS];
  double swapped[SIZE];
  swap_order(pair, swapped);
  for (int o = 0; o < overlap->rule.order_count; o++)
    if (!contact_normalise(overlap->model.kind, o ? swapped : pair, &normalised[o])) return false;
  for (int o = 0; o < overlap->rule.order_count; o++)
    contact_net_model_lay(&overlap->model, desk, normalised[o].pair);
  return true;
}

static void tell_logits(const NetOverlap *overlap, ContactNetDesk *desk, int count, const double *pairs,
                        double *logits) {
  bool is_laid[ROWS];
  int n = overlap->rule.order_count;
  desk->row_count = 0;
  for (int i = 0; i < count; i++) is_laid[i] = lay_pair(overlap, desk, pairs + (ptrdiff_t)i * SIZE);
  desk->work.outputs = STATUS;
  net_forward_eval_f32(&desk->work, &overlap->model.network, desk->row_count, desk->x, desk->y);
  const float *y = desk->y;
  for (int i = 0; i < count; i++) {
    logits[i] = is_laid[i] ? 0 : -INFINITY;
    for (int o = 0; o < n && is_laid[i]; o++, y += 2) logits[i] += (double)y[0] / n;
  }
}

Status contact_net_overlap_logits(const void *self, int count, const double *pairs, double *logits) {
  const NetOverlap *overlap = self;
  ContactNetDesk *desk = contact_net_model_take(&overlap->model);
  int size = ROWS / overlap->rule.order_count;
  for (int first = 0; first < count; first += size)
    tell_logits(overlap, desk, count - first < size ? count - first : size, pairs + (ptrdiff_t)first * SIZE,
                logits + first);
  contact_net_model_leave(desk);
  return STATUS_OK;
}

// ---- The models.

static const ContactNetOptions as_published = {.ghosts = CONTACT_NET_GHOSTS_KEEP,
                                               .gate = CONTACT_NET_GATE_NONE,
                                               .orders = CONTACT_NET_ORDERS_ONE,
                                               .beyond = CONTACT_NET_BEYOND_COUNT};
static const ContactNetOptions for_scenes = {.ghosts = CONTACT_NET_GHOSTS_FADE,
                                             .gate = CONTACT_NET_GATE_STATUS,
                                             .orders = CONTACT_NET_ORDERS_BOTH,
                                             .beyond = CONTACT_NET_BEYOND_COUNT};
static const ContactNetOptions for_hybrid = {.ghosts = CONTACT_NET_GHOSTS_FADE,
                                             .gate = CONTACT_NET_GATE_NONE,
                                             .orders = CONTACT_NET_ORDERS_BOTH,
                                             .beyond = CONTACT_NET_BEYOND_EXACT};

Status contact_net_overlap_create(void **self, const char *path, const ContactNetOptions *options) {
  return create(self, path, options, &as_published, false);
}

// `weights`: a file, or the name of one that ships; NULL: `own`.
static Status create_named(void **self, const char *weights, const char *own, const ContactNetOptions *given,
                           const ContactNetOptions *standard, bool is_hybrid) {
  char path[4096];
  if (!weights) weights = own;
  if (contact_weights_is_path(weights)) return create(self, weights, given, standard, is_hybrid);
  TRY(contact_weights_find(weights, path, sizeof path));
  return create(self, path, given, standard, is_hybrid);
}

static Status create_tpn(void **self, const char *weights, const ContactNetOptions *options) {
  return create_named(self, weights, "tpn", options, &as_published, false);
}

static Status create_tpn_scene(void **self, const char *weights, const ContactNetOptions *options) {
  return create_named(self, weights, "tpn-scene", options, &for_scenes, false);
}

static Status create_hybrid(void **self, const char *weights, const ContactNetOptions *options) {
  return create_named(self, weights, "tpn-scene", options, &for_hybrid, true);
}

static bool has_ghosts(const void *self) {
  return ((const NetOverlap *)self)->ghosts == CONTACT_NET_GHOSTS_KEEP;
}

const ContactOverlapOps contact_overlap_tpn = {
    .name = "tpn",
    .help = "learned: the paper's TetrahedronPairNet; its gradient jumps, disjoint pairs feel ghosts",
    .has_hessian = false,
    .seconds_per_pair = 3e-6,
    .create = create_tpn,
    .has_ghosts = has_ghosts,
    .eval_logits = contact_net_overlap_logits,
    .eval_pair = contact_net_overlap_eval_pair,
    .eval_batch = contact_net_overlap_eval_batch,
    .destroy = contact_net_overlap_destroy,
};

const ContactOverlapOps contact_overlap_tpn_scene = {
    .name = "tpn-scene",
    .help = "learned: a TetrahedronPairNet made fit for scenes: gated, in both orders, no ghosts",
    .has_hessian = false,
    .seconds_per_pair = 1.2e-5,
    .create = create_tpn_scene,
    .has_ghosts = has_ghosts,
    .eval_logits = contact_net_overlap_logits,
    .eval_pair = contact_net_overlap_eval_pair,
    .eval_batch = contact_net_overlap_eval_batch,
    .destroy = contact_net_overlap_destroy,
};

const ContactOverlapOps contact_overlap_hybrid = {
    .name = "hybrid",
    .help = "a TetrahedronPairNet where it is confident, shallow and in range; exact elsewhere",
    .has_hessian = false,
    .seconds_per_pair = 2e-5,
    .create = create_hybrid,
    .eval_pair = contact_net_overlap_eval_pair,
    .eval_batch = contact_net_overlap_eval_batch,
    .destroy = contact_net_overlap_destroy,
};
