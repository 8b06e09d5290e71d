// SPDX-License-Identifier: GPL-3.0-or-later
// Whether an overlap model saves steps: each run is compared with that of the first model on the same scene,
// mesh and tolerance; the ratios and their spread.
#ifndef TETLAP_LAB_PRECISION_SUMMARY_H
#define TETLAP_LAB_PRECISION_SUMMARY_H

#include <stdbool.h>

#include "app/bench/options.h"
#include "base/status.h"

typedef struct LabPrecisionRun {
  const char *scene, *overlap; // borrowed
  double level, tolerance;
  bool is_finished;
  double steps, rejected, newton_iterations, setups, cpu_s, wall_s, overlap_s, force_error, trajectory_error;
} LabPrecisionRun;

// Over the pairs of runs of which both finished. A ratio is model over base: 0.9 is a tenth saved.
typedef struct LabPrecisionSummary {
  const char *overlap, *base;
  long long pairs;                                     // of runs
  long long unfinished;                                // runs of the model that did not finish
  double steps, steps_min, steps_max, steps_deviation; // geometric mean, extremes, standard deviation of ln
  double newton, newton_min, newton_max;
  double setups;
  double rejected, rejected_base;             // sums
  double rejected_share, rejected_share_base; // over the accepted steps
  double cpu, wall_rest;                      // processor time; wall time without the overlap model
  double force_error;                         // geometric mean of the ratio of errors
} LabPrecisionSummary;

LabPrecisionSummary lab_precision_summary_make(const char *overlap, const char *base,
                                               const LabPrecisionRun *runs, int count);

// A row a model, in the options' format; the first model is the base. In JSON the rows' `bench` is
// "precision_summary".
Status lab_precision_summary_print(const AppBenchOptions *options, const char *const *overlaps,
                                   int overlap_count, const LabPrecisionRun *runs, int count);

#endif
