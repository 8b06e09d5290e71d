// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of a scene's law, for the tests of training.
#pragma once

#include "suite.h"

#include "app/dataset/source.h"

static inline DatagenPairs load_pairs(int count, size_t *loaded) {
  AppSourceDef def = {.law = "scene", .mix = "scene=1", .count = count, .seed = 3};
  DatagenPairs pairs;
  ck_assert_ok(app_dataset_source_load(&def, &pairs, loaded));
  return pairs;
}
