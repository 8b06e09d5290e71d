// SPDX-License-Identifier: GPL-3.0-or-later
// The frontier of accuracy and time: every overlap model, and every size of network that was trained, with
// its error and its time in one run on one machine, for V, for ∇V, and for the contact forces of whole
// scenes.
//
//   create ─► add models ─► measure pairs ─► measure scenes ─► finish ─► points, comparisons
//                           (pareto_pairs)   (pareto_scenes)
//
// What is not measured is NaN.
#ifndef TETLAP_LAB_PARETO_PARETO_H
#define TETLAP_LAB_PARETO_PARETO_H

#include <signal.h>

#include "app/bench/report.h"
#include "app/cli/model_names.h"
#include "app/evaluation/card.h"

enum { LAB_PARETO_MAX_MODELS = 96, LAB_PARETO_MAX_SCENES = 8 };

typedef struct LabParetoModel {
  AppModelName name;    // what it is called beside the others (app/cli/model_names.h)
  char source[512];     // what a scene names: a name, or a file's path
  OverlapModel overlap; // owned
  AppModelCard card;
} LabParetoModel;

// One dot: a model on a set of pairs, or in a scene.
typedef struct LabParetoPoint {
  const char *model, *family, *quantity,
      *set;           // borrowed; quantity: V, V+grad, force; set: near, uniform or a scene
  const char *device; // borrowed; NULL: this processor
  long long features, width, depth, parameters; // 0 where nothing is learned
  double seconds, seconds_min, seconds_max;     // kernel: wall time of the overlap model for a pair [s]
  double cost;                                  // what the frontier goes by [s], see lab_pareto_finish
  double cpu_seconds;                           // processor time of all threads for a pair, median [s]
  double error, error_median, error_p90; // of V or of ∇V over pairs; of the forces over configurations
  double fallbacks;                      // share of pairs that a more careful model answered
  long long samples;                     // pairs or configurations that the error is taken over
  bool is_frontier;                      // no other point of this set and quantity is faster and as accurate
  // whole scenes: a run of the model's own
  const char *outcome; // finished, cut short, failed; NULL: no run
  double step_s;       // wall time of a step, all phases [s]
  double share;        // of the overlap model in the run's wall time
  double limit;        // Amdahl: how many times faster the run would be if the overlap took no time
  double trajectory_error, run_force_error; // against the reference's run
  long long steps, rejected;
  long long frontier; // is_frontier, for tables
} LabParetoPoint;

// Two models' speeds side by side, with a name that says what is compared.
typedef struct LabParetoComparison {
  const char *name, *set, *quantity, *slow, *fast; // borrowed
  double slow_rate, fast_rate;                     // pairs a second
  double ratio, ratio_min, ratio_max;              // fast over slow, within rounds: median, extremes
  double slow_error, fast_error;
  double paper_ratio; // what the paper's own figures say; NaN: nothing
} LabParetoComparison;

enum { LAB_PARETO_MAX_COMPARISONS = 8 };

typedef struct LabPareto {
  AppBenchOptions common;
  int batch;           // pairs a call
  int error_pairs;     // that errors are taken over
  double scene_wall_s; // what a run of a scene may take [s]
  int scene_rounds;    // runs of a scene a model
  int audit_every; // steps in contact between configurations in which all models are held against the exact
                   // one
  const volatile sig_atomic_t *stop; // not 0: measuring ends; NULL: it cannot be stopped
  const char *device;                // pairs also on this one, as --device has it; NULL: none
  LabParetoModel *models;            // (model_count), owned
  char device_names[LAB_PARETO_MAX_MODELS][APP_MODEL_NAME + 16]; // of models on the device: NAME@DEVICE
  int model_count;
  LabParetoPoint *points; // (point_count), owned
  size_t point_count, point_capacity;
  LabParetoComparison comparisons[LAB_PARETO_MAX_COMPARISONS];
  int comparison_count;
} LabPareto;

Status lab_pareto_create(LabPareto *pareto);
// STATUS_INTERRUPTED where `stop` is set.
Status lab_pareto_go_on(const LabPareto *pareto);
void lab_pareto_destroy(LabPareto *pareto); // a zeroed one is accepted

// By name or weights file. STATUS_IO: weights that are not there.
Status lab_pareto_add_model(LabPareto *pareto, const char *source);

// Room for one more point, with the model's own columns filled and all figures NaN; NULL: no memory.
LabParetoPoint *lab_pareto_add_point(LabPareto *pareto, int model, const char *quantity, const char *set);

// At least as cheap and as accurate, and better in one of both; of points of one set and quantity.
bool lab_pareto_beats(const LabParetoPoint *a, const LabParetoPoint *b);

// Marks the frontier of each set and quantity, of a device's points by themselves. Of one thread processor
// time counts, which other work on the machine hardly changes; of several, and in scenes, wall time. A point
// is on it unless another one is at least as fast and at least as accurate, and better in one of both.
void lab_pareto_finish(LabPareto *pareto);

extern const AppBenchReport lab_pareto_report, lab_pareto_comparison_report;

// pareto.json, pareto.csv into the directory, which is made.
Status lab_pareto_write(const LabPareto *pareto, const char *directory);

#endif
