// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/model.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/portions.h"
#include "overlap/tpn/portion.h"
#include "overlap/weights.h"

enum { SIZE = OVERLAP_PAIR_SIZE, ROWS = OVERLAP_TPN_ROWS };
enum { STATUS = 1 << 0 }; // the network's first output

OverlapOptions overlap_options_default(void) {
  return (OverlapOptions){.touch = 0.02, .deep = 0.3, .doubt = 0.005, .confidence = 0.95};
}

void overlap_tpn_model_destroy(void *self) {
  OverlapTpnModel *overlap = self;
  if (!overlap) return;
  overlap_tpn_network_destroy(&overlap->model);
  memory_free(overlap);
}

// Fills in what the options leave to the model.
static OverlapOptions resolve(const OverlapOptions *given, const OverlapOptions *own) {
  OverlapOptions options = given ? *given : overlap_options_default();
  if (options.ghosts == OVERLAP_GHOSTS_AUTO) options.ghosts = own->ghosts;
  if (options.gate == OVERLAP_GATE_AUTO) options.gate = own->gate;
  if (options.orders == OVERLAP_ORDERS_AUTO) options.orders = own->orders;
  if (options.coplanar == OVERLAP_COPLANAR_AUTO) options.coplanar = own->coplanar;
  if (options.beyond == OVERLAP_BEYOND_AUTO) options.beyond = own->beyond;
  return options;
}

static Status set_rule(OverlapTpnModel *overlap, const OverlapOptions *options, bool is_hybrid,
                       const char *path) {
  const OverlapTpnNetwork *model = &overlap->model;
  overlap->ghosts = is_hybrid ? OVERLAP_GHOSTS_FADE : options->ghosts;
  overlap->turns_to_clip = options->coplanar == OVERLAP_COPLANAR_CLIP;
  overlap->rule = (OverlapTpnRule){.fades = !is_hybrid && options->ghosts == OVERLAP_GHOSTS_FADE,
                                   .gates = options->gate == OVERLAP_GATE_STATUS,
                                   .rounds = is_hybrid || options->gate == OVERLAP_GATE_STATUS,
                                   .is_hybrid = is_hybrid,
                                   .keeps_to_range = options->beyond == OVERLAP_BEYOND_EXACT,
                                   .has_range = model->has_range,
                                   .range = model->range,
                                   .order_count = options->orders == OVERLAP_ORDERS_BOTH ? 2 : 1,
                                   .touch = options->touch,
                                   .deep = options->deep,
                                   .logit = log(options->confidence / (1 - options->confidence)),
                                   .scale = model->scale};
  if (overlap->rule.keeps_to_range && !model->has_range)
    return status_fail(STATUS_INPUT,
                       "%s: does not say which pairs it was trained on (range: '%s'), so pairs beyond it "
                       "cannot be detected; `tetlap weights --range` writes it into the file",
                       path, model->card.range);
  return overlap_geo_create(&overlap->closed, NULL);
}

static Status create(void **self, const char *path, const OverlapOptions *given, const OverlapOptions *own,
                     bool is_hybrid, NetKernelKind kernel) {
  OverlapOptions options = resolve(given, own);
  OverlapTpnModel *overlap = memory_zeroed(1, sizeof *overlap);
  if (!overlap) return status_no_memory("an overlap model");
  Status status = overlap_tpn_network_create(&overlap->model, path, kernel, overlap_tpn_portion_size());
  if (!status) status = set_rule(overlap, &options, is_hybrid, path);
  if (!status)
    *self = overlap;
  else
    overlap_tpn_model_destroy(overlap);
  return status;
}

static Status eval_portion(const void *self, const OverlapBatch *portion, int first) {
  const OverlapTpnModel *overlap = self;
  (void)first;
  OverlapTpnWorkspace *workspace = overlap_tpn_network_acquire(&overlap->model);
  Status status = overlap_tpn_portion_eval(overlap, portion, workspace);
  overlap_tpn_network_release(workspace);
  return status;
}

Status overlap_tpn_model_eval_batch(const void *self, const OverlapBatch *batch) {
  int rows = batch->hessian ? OVERLAP_TPN_BENT_ROWS : ROWS;
  int size = rows / ((const OverlapTpnModel *)self)->rule.order_count;
  return overlap_portions_eval(batch, size, true, eval_portion, self);
}

Status overlap_tpn_model_eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch batch = overlap_ops_single(pair, answer);
  return eval_portion(self, &batch, 0);
}

// Adds the pair's rows if the normalisation takes it.
static bool add_normalised_row(const OverlapTpnModel *overlap, OverlapTpnWorkspace *workspace,
                               const double pair[SIZE]) {
  OverlapTpnNormalised normalised[OVERLAP_TPN_MAX_ORDERS];
  double swapped[SIZE];
  overlap_ops_swap(pair, swapped);
  for (int o = 0; o < overlap->rule.order_count; o++)
    if (!overlap_tpn_normalise(overlap->model.kind, o ? swapped : pair, &normalised[o])) return false;
  for (int o = 0; o < overlap->rule.order_count; o++)
    overlap_tpn_network_add_row(&overlap->model, workspace, normalised[o].pair);
  return true;
}

static void tell_logits(const OverlapTpnModel *overlap, OverlapTpnWorkspace *workspace, int count,
                        const double *pairs, double *logits) {
  bool is_asked[ROWS];
  int n = overlap->rule.order_count;
  workspace->row_count = 0;
  for (int i = 0; i < count; i++)
    is_asked[i] = add_normalised_row(overlap, workspace, pairs + (ptrdiff_t)i * SIZE);
  workspace->work.outputs = STATUS;
  net_forward_eval_f32(&workspace->work, &overlap->model.network, workspace->row_count, workspace->x,
                       workspace->y);
  const float *y = workspace->y;
  for (int i = 0; i < count; i++) {
    logits[i] = is_asked[i] ? 0 : -INFINITY;
    for (int o = 0; o < n && is_asked[i]; o++, y += 2) logits[i] += (double)y[0] / n;
  }
}

Status overlap_tpn_model_logits(const void *self, int count, const double *pairs, double *logits) {
  const OverlapTpnModel *overlap = self;
  OverlapTpnWorkspace *workspace = overlap_tpn_network_acquire(&overlap->model);
  int size = ROWS / overlap->rule.order_count;
  for (int first = 0; first < count; first += size)
    tell_logits(overlap, workspace, count - first < size ? count - first : size,
                pairs + (ptrdiff_t)first * SIZE, logits + first);
  overlap_tpn_network_release(workspace);
  return STATUS_OK;
}

// ---- The models.

static const OverlapOptions as_published = {.ghosts = OVERLAP_GHOSTS_KEEP,
                                            .gate = OVERLAP_GATE_NONE,
                                            .orders = OVERLAP_ORDERS_ONE,
                                            .beyond = OVERLAP_BEYOND_COUNT,
                                            .coplanar = OVERLAP_COPLANAR_KEEP};
static const OverlapOptions for_scenes = {.ghosts = OVERLAP_GHOSTS_FADE,
                                          .gate = OVERLAP_GATE_STATUS,
                                          .orders = OVERLAP_ORDERS_BOTH,
                                          .beyond = OVERLAP_BEYOND_COUNT,
                                          .coplanar = OVERLAP_COPLANAR_KEEP};
static const OverlapOptions for_hybrid = {.ghosts = OVERLAP_GHOSTS_FADE,
                                          .gate = OVERLAP_GATE_NONE,
                                          .orders = OVERLAP_ORDERS_BOTH,
                                          .beyond = OVERLAP_BEYOND_EXACT,
                                          .coplanar = OVERLAP_COPLANAR_CLIP};

// `weights`: a file, or the name of one that ships; NULL: `own`.
static Status create_named(void **self, const char *weights, const char *own, const OverlapOptions *given,
                           const OverlapOptions *standard, bool is_hybrid, NetKernelKind kernel) {
  char path[4096];
  if (!weights) weights = own;
  if (overlap_weights_is_path(weights)) return create(self, weights, given, standard, is_hybrid, kernel);
  TRY(overlap_weights_find(weights, path, sizeof path));
  return create(self, path, given, standard, is_hybrid, kernel);
}

static Status create_tpn(void **self, const char *weights, const OverlapOptions *options) {
  return create_named(self, weights, "tpn", options, &as_published, false, net_kernel_best());
}

static Status create_tpn_bf16(void **self, const char *weights, const OverlapOptions *options) {
  return create_named(self, weights, "tpn", options, &as_published, false, NET_KERNEL_BF16);
}

static Status create_tpn_published(void **self, const char *weights, const OverlapOptions *options) {
  return create_named(self, weights, "tpn-published", options, &as_published, false, net_kernel_best());
}

static Status create_tpn_scene(void **self, const char *weights, const OverlapOptions *options) {
  return create_named(self, weights, "tpn-scene", options, &for_scenes, false, net_kernel_best());
}

static Status create_hybrid(void **self, const char *weights, const OverlapOptions *options) {
  return create_named(self, weights, "tpn-scene", options, &for_hybrid, true, net_kernel_best());
}

static bool has_hessian(const void *self) {
  return overlap_tpn_portion_has_hessian(&((const OverlapTpnModel *)self)->model);
}

static bool has_ghosts(const void *self) {
  return ((const OverlapTpnModel *)self)->ghosts == OVERLAP_GHOSTS_KEEP;
}

const OverlapOps overlap_tpn_ops = {
    .name = "tpn",
    .help = "learned, after TetrahedronPairNet; its gradient jumps, disjoint pairs get ghost forces",
    .has_hessian = has_hessian,
    .seconds_per_pair = 3e-6,
    .create = create_tpn,
    .has_ghosts = has_ghosts,
    .eval_logits = overlap_tpn_model_logits,
    .eval_pair = overlap_tpn_model_eval_pair,
    .eval_batch = overlap_tpn_model_eval_batch,
    .destroy = overlap_tpn_model_destroy,
};

const OverlapOps overlap_tpn_bf16_ops = {
    .name = "tpn-bf16",
    .help = "learned: tpn with factors rounded to bf16: faster where the processor has AVX512_BF16",
    .has_hessian = has_hessian,
    .seconds_per_pair = 2e-6,
    .create = create_tpn_bf16,
    .has_ghosts = has_ghosts,
    .eval_logits = overlap_tpn_model_logits,
    .eval_pair = overlap_tpn_model_eval_pair,
    .eval_batch = overlap_tpn_model_eval_batch,
    .destroy = overlap_tpn_model_destroy,
    .weights = "tpn",
};

const OverlapOps overlap_tpn_published_ops = {
    .name = "tpn-published",
    .help = "learned: TetrahedronPairNet as its authors train it; has no scale as input, so V is inaccurate",
    .has_hessian = has_hessian,
    .seconds_per_pair = 3e-6,
    .create = create_tpn_published,
    .lacks_scale = true,
    .has_ghosts = has_ghosts,
    .eval_logits = overlap_tpn_model_logits,
    .eval_pair = overlap_tpn_model_eval_pair,
    .eval_batch = overlap_tpn_model_eval_batch,
    .destroy = overlap_tpn_model_destroy,
};

const OverlapOps overlap_tpn_scene_ops = {
    .name = "tpn-scene",
    .help = "learned, after TetrahedronPairNet, adapted to scenes: gated, in both orders, no ghosts",
    .has_hessian = has_hessian,
    .seconds_per_pair = 1.2e-5,
    .create = create_tpn_scene,
    .has_ghosts = has_ghosts,
    .eval_logits = overlap_tpn_model_logits,
    .eval_pair = overlap_tpn_model_eval_pair,
    .eval_batch = overlap_tpn_model_eval_batch,
    .destroy = overlap_tpn_model_destroy,
};

const OverlapOps overlap_tpn_hybrid_ops = {
    .name = "hybrid",
    .help = "the network of tpn-scene where it is confident, shallow and in range; exact elsewhere",
    .has_hessian = has_hessian,
    .seconds_per_pair = 2e-5,
    .create = create_hybrid,
    .eval_pair = overlap_tpn_model_eval_pair,
    .eval_batch = overlap_tpn_model_eval_batch,
    .destroy = overlap_tpn_model_destroy,
};
