// SPDX-License-Identifier: GPL-3.0-or-later
// The accuracy of an overlap model on labelled pairs: the paper's Table 4 and, beyond it, derivatives, ghosts
// on disjoint pairs, and symmetries of the true volume.
//
//   begin ─► add, block by block ─► finish ─► AppEvaluation
//
// V is in cubes of the unit cube's edge, ∇V in its squares. Results do not depend on the number of threads
// nor on how pairs are cut into blocks.
#ifndef TETLAP_APP_EVALUATION_EVALUATION_H
#define TETLAP_APP_EVALUATION_EVALUATION_H

#include <stdbool.h>
#include <stddef.h>

#include "app/evaluation/bounds.h"
#include "datagen/law/kind.h"
#include "datagen/pairs.h"
#include "overlap/model.h"

enum {
  APP_EVALUATION_BINS = 3,
  APP_EVALUATION_SYMMETRY_PAIRS = 10000,
  APP_EVALUATION_CONFIDENCES = 10, // bins of the predicted probability
};

// What a set of pairs without anything to measure gives is NaN.
typedef struct AppEvaluationKind {
  long long count;
  double accuracy;         // share of pairs whose status is right
  double accuracy_swapped; // likewise, the two tetrahedra exchanged
  double volume_mae;       // mean |ΔV|
} AppEvaluationKind;

typedef struct AppEvaluation {
  long long count;  // pairs
  long long inside; // with V > 0: what mae … angle_p90_deg are taken over
  long long fallbacks, blended;
  long long unsound; // V was below 0, and counts as 0, or is above the smaller tetrahedron
  double handed_on, handed_on_in_part; // shares of those with V > 0 that a more careful model answers
  AppEvaluationKind kinds[DATAGEN_KIND_COUNT];
  double accuracy_mean, accuracy_swapped_mean;      // mean over the kinds that there are
  double mae;                                       // mean |ΔV|
  double bin_mae[APP_EVALUATION_BINS];              // by the true V; beyond the last end belongs to the last
  double bin_share[APP_EVALUATION_BINS];            // of pairs in each bin
  double bin_accuracy[APP_EVALUATION_BINS];         // share whose V falls into the right bin
  double volume_error_sum;                          // Σ|ΔV| / ΣV
  double gradient_error;                            // Σ‖Δ∇V‖ / Σ‖∇V‖
  double gradient_error_median, gradient_error_p90; // of ‖Δ∇V‖ / ‖∇V‖
  // Between the force Σ ∇V on the first tetrahedron and the true one.
  double angle_median_deg, angle_p90_deg;
  // Σ|Δm| / Σ|m| over the moments m_z = V λ_z(x̄) of the eight vertices, with the true V: what the centroid is
  // off; and with the model's own. NaN: the model has no centroid.
  double moment_error, moment_error_own;
  double ghost_volume;   // mean V given for pairs that share no volume
  double ghost_gradient; // mean ‖∇V‖ given for them
  // Σ|V(changed pair) − V| / ΣV over the first APP_EVALUATION_SYMMETRY_PAIRS pairs with V > 0: another order
  // of either's vertices, the two exchanged, a rotation about the cube's centre
  double defect_vertex_order, defect_swap, defect_rotation;
  bool has_status; // the model gives a status of its own, a logit
  AppEvaluationBounds bounds;
  double calibration_error; // Σ over bins of share · |predicted probability − frequency| (Naeini et al. 2015)
} AppEvaluation;

// Logits of the status, positive: the pair intersects; as overlap_tpn_model_logits.
typedef Status (*AppEvaluationLogits)(const void *self, int count, const double *pairs, double *logits);

typedef struct AppEvaluationRun {
  const OverlapModel *model;  // borrowed
  AppEvaluationLogits logits; // NULL: the model gives no status
  AppEvaluation sums;         // not yet divided
  AppEvaluationBoundsRun bounds;
  long long bins[APP_EVALUATION_BINS];
  double true_volume, true_gradient, true_moments; // Σ
  double symmetry_volume;                          // Σ V given for the pairs that symmetries are tried on
  long long symmetry_count;
  long long outside;                // pairs that share no volume
  double *gradient_errors, *angles; // (inside), (angle_count), owned
  size_t gradient_capacity, angle_capacity;
  size_t angle_count;
  double probability[APP_EVALUATION_CONFIDENCES]; // Σ of those in the bin
  long long confident[APP_EVALUATION_CONFIDENCES], intersecting[APP_EVALUATION_CONFIDENCES];
} AppEvaluationRun;

// Borrows the model. `logits` may be NULL. End it, whatever happens.
void app_evaluation_begin(AppEvaluationRun *run, const OverlapModel *model, AppEvaluationLogits logits);
// Evaluates `count` pairs. Without `pairs->gradient` or `pairs->centroid` the true ones are those of
// clipping, checked as data sets check it. A model with logits is right about a pair if their sign says
// whether the closed tetrahedra meet; one without says no more than V, and is right if V > 0 just where the
// two share volume.
Status app_evaluation_add(AppEvaluationRun *run, const DatagenPairs *pairs, size_t count);
// Barycentric coordinates (8) of a point in both tetrahedra of a pair; false: one is flat.
bool app_evaluation_coordinates(const double pair[24], const double x[3], double lambda[8]);
void app_evaluation_finish(AppEvaluationRun *run, AppEvaluation *result);
void app_evaluation_end(AppEvaluationRun *run); // a zeroed one is accepted

#endif
