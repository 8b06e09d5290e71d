// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives by the weights of an overlap model's network, along ways that are drawn.
#ifndef TETLAP_TESTS_WEIGHTS_H
#define TETLAP_TESTS_WEIGHTS_H

#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "folder.h"
#include "overlap/models.h"
#include "suite.h"

// Differences of fourth order. Weights into which whitening was folded cancel: a longer step is no small one.
enum { WEIGHTS_PLACES = 4 };
static const double weights_step = 2e-8, weights_places[WEIGHTS_PLACES] = {-2, -1, 1, 2},
                    weights_factors[WEIGHTS_PLACES] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};

typedef struct Weights {
  OverlapModel model;
  size_t count;
  const char *prefix; // of a file's name in a scene
  double *own, *way, *moved;
} Weights;

static inline Weights weights_open(const char *name) {
  Weights weights;
  Random random = random_seeded(3, 0);
  ck_assert_ok(overlap_models_create(&weights.model, name));
  weights.prefix = strcmp(name, "hybrid") == 0 ? "hybrid=" : "";
  weights.count = weights.model.ops->training->count(weights.model.self);
  weights.own = calloc(weights.count, sizeof(double));
  weights.way = calloc(weights.count, sizeof(double));
  weights.moved = calloc(weights.count, sizeof(double));
  weights.model.ops->training->read(weights.model.self, weights.own);
  for (size_t i = 0; i < weights.count; i++) weights.way[i] = weights.own[i] * suite_normal(&random);
  return weights;
}

static inline void weights_close(Weights *weights) {
  overlap_model_destroy(&weights->model);
  free(weights->own), free(weights->way), free(weights->moved);
}

static inline double weights_along(const Weights *weights, const double *slope) {
  double along = 0;
  for (size_t i = 0; i < weights->count; i++) along += slope[i] * weights->way[i];
  return along;
}

// Writes the weights that lie at a place on the way; a setting that names them.
static inline void weights_write(Weights *weights, double place, char setting[400]) {
  char path[300];
  snprintf(path, sizeof path, "%s/moved.safetensors", folder);
  snprintf(setting, 400, "contact.overlap=%s%s", weights->prefix, path);
  for (size_t i = 0; i < weights->count; i++)
    weights->moved[i] = weights->own[i] + place * weights_step * weights->way[i];
  ck_assert_ok(weights->model.ops->training->write(weights->model.self, weights->moved, path));
  if (!*weights->prefix) return;
  char command[800]; // its bound stays
  snprintf(command, sizeof command,
           "cp %s/net/weights/geo-small-bound.safetensors %s/moved-bound.safetensors", TETLAP_SOURCE_DIR,
           folder);
  ck_assert_int_eq(system(command), 0);
}

#endif
