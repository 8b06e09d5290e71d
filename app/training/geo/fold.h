// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of a network that was trained on whitened features, written for features as they are: the whitening
// is folded into its first layer, in double precision.
#ifndef TETLAP_APP_TRAINING_GEO_FOLD_H
#define TETLAP_APP_TRAINING_GEO_FOLD_H

#include "base/status.h"
#include "net/net.h"

typedef struct AppTrainingFold { // all borrowed
  const NetModel_f32 *model;
  const NetWhitening *whitening; // of the inputs
  char *normalisation, *range;   // of the file's card (net/files/weights.h)
  const char *provenance;
  void (*finish)(const void *self, NetModel_f64 *folded); // what else the outputs take
  const void *self;
} AppTrainingFold;

// STATUS_MEMORY, and those of writing.
Status app_training_fold_write(const AppTrainingFold *fold, const char *path);

#endif
