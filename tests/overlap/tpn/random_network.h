// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet with random weights in a file of the test's own, and pairs to ask it about.
#pragma once

#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "net/files/weights.h"
#include "overlap/exact/exact.h"
#include "overlap/models.h"

static char path[64];

static const char RANGE[] =
    "radius 0.5 to 2, first volume 0.1 to 0.2, second volume 0.01 to 1, overlap to 0.15";

// Random weights. `volume`: what the volume head says, about; `logit`: likewise.
static inline void write_shape(const NetShape *shape, const char *normalisation, const char *range,
                               float volume, float logit) {
  NetModel_f32 model;
  char input[64], covered[160], provenance[] = "random weights";
  snprintf(input, sizeof input, "%s", normalisation);
  snprintf(covered, sizeof covered, "%s", range);
  NetCard card = {.normalisation = input, .range = covered, .provenance = provenance};
  snprintf(path, sizeof path, "/tmp/test_network_%d.safetensors", (int)getpid());
  ck_assert_int_eq(net_model_create_f32(shape, &model), NET_OK);
  net_model_initialise_f32(&model, 3);
  float *volume_bias = NULL, *logit_bias = NULL;
  for (int k = 0; k < model.plan->tensor_count; k++) {
    const NetTensor *tensor = &model.plan->tensors[k];
    if (tensor->rows != 1 || tensor->columns != 0) continue;
    if (strncmp(tensor->name, "volume", 6) == 0) volume_bias = model.parameters + tensor->offset;
    if (strncmp(tensor->name, "status", 6) == 0) logit_bias = model.parameters + tensor->offset;
  }
  ck_assert(volume_bias && logit_bias);
  *volume_bias = volume;
  *logit_bias = logit;
  ck_assert_int_eq(net_weights_write_f32(path, &model, &card), NET_OK);
  net_model_destroy_f32(&model);
}

static inline void write_network(const char *normalisation, NetActivation activation) {
  NetShape shape = net_shape_tpn_a();
  shape.activation = activation;
  // V > 0 whatever the input; not larger than needed, for float's rounding
  write_shape(&shape, normalisation, RANGE, normalisation[0] == 'p' ? 2 : 40, 0);
}

// A network whose V has a continuous gradient.
static inline void write_smooth(float volume, float logit) {
  NetShape shape = net_shape_tpn_a();
  shape.activation = NET_SILU;
  shape.pool = NET_SUM;
  write_shape(&shape, "unit, V times 1000", RANGE, volume, logit);
}

static inline void draw_pairs(uint64_t seed, int count, double *pairs) {
  Random random = random_seeded(seed, 0);
  for (int i = 0; i < 24 * count; i++) pairs[i] = random_uniform(&random);
}

static inline OverlapModel open_with(const char *name, OverlapOptions options) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create_with(&model, name, path, &options));
  return model;
}

typedef struct Answer {
  double volume, gradient[24];
  unsigned flags;
} Answer;

static inline Answer ask(const OverlapModel *model, const double pair[24]) {
  Answer answer;
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = pair,
                        .volume = &answer.volume,
                        .gradient = answer.gradient,
                        .flags = &answer.flags};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

// The unit simplex, and the same moved along the diagonal: they touch where `by` is 1/3, share 1/6 where it
// is 0.
static inline void slide(double by, double pair[24]) {
  static const double simplex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int i = 0; i < 12; i++) pair[i] = simplex[i], pair[12 + i] = simplex[i] + by;
}

static inline double exact_volume(const double pair[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_exact_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}
