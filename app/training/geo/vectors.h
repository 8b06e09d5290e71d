// SPDX-License-Identifier: GPL-3.0-or-later
// What training the centroid of `geo` sees of its pairs, computed once: the vectors that its planes' own
// features make in the frame, Σ_k e_mk q_k, whitened as samples of either sign, and the centroid's z in the
// same frame (overlap/geo/geo.h). Of the same pairs as the pool, in the same order.
#ifndef TETLAP_APP_TRAINING_GEO_VECTORS_H
#define TETLAP_APP_TRAINING_GEO_VECTORS_H

#include "datagen/pairs.h"
#include "net/model/model.h"
#include "net/model/whitening.h"
#include "overlap/geo/features/features.h"

typedef struct AppTrainingVectors {
  const OverlapGeoFeatureSet *set;
  int count, vector_count;
  float *vectors;         // (count, vector_count, 3)
  float *targets;         // z                     (count, 3)
  NetWhitening whitening; // its mean is 0; owned
} AppTrainingVectors;

// From the pairs (with x̄) that have a frame; at least two have.
Status app_training_vectors_create(AppTrainingVectors *vectors, const OverlapGeoFeatureSet *set,
                                   const DatagenPairs *pairs, size_t count);
void app_training_vectors_destroy(AppTrainingVectors *vectors); // a zeroed one is accepted

// Huber's function of |Σ_m y_m v_m − z| of a sample, and its derivative by y (vector_count).
double app_training_vectors_loss(const AppTrainingVectors *vectors, int sample, double delta, const float *y,
                                 float *gy);

// Coefficients of the whitened vectors, rows of the last layer, become those of the vectors: the network that
// is written takes no part in whitening.
void app_training_vectors_fold(const NetWhitening *whitening, NetModel_f64 *model);

#endif
