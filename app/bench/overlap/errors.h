// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of V and ∇V of overlap models on a set of pairs, against the exact model.
#ifndef TETLAP_APP_BENCH_OVERLAP_ERRORS_H
#define TETLAP_APP_BENCH_OVERLAP_ERRORS_H

#include "overlap/model.h"

// The pairs and what is true of them.
typedef struct AppBenchTruth {
  int count;
  const double *pairs;       // (count, 24), borrowed
  double *volume, *gradient; // (count), (count, 24), owned
} AppBenchTruth;

typedef struct AppBenchErrors {
  double error;       // Σ|ΔV| / ΣV, or Σ‖Δ∇V‖ / Σ‖∇V‖; NaN: no pair shares volume
  double median, p90; // of the single pairs' relative errors
  double fallbacks;   // share of the pairs that a more careful model answered
  long long samples;  // pairs that this is taken over
} AppBenchErrors;

Status app_bench_truth_create(AppBenchTruth *truth, int count, const double *pairs);
void app_bench_truth_destroy(AppBenchTruth *truth); // a zeroed one is accepted

// Of the first `count` pairs: of ∇V if `of_gradient`, else of V. STATUS_MEMORY, or the model's own failure.
Status app_bench_errors_measure(const AppBenchTruth *truth, const OverlapModel *model, int count,
                                bool of_gradient, AppBenchErrors *errors);

#endif
