// SPDX-License-Identifier: GPL-3.0-or-later
// The result of a run: times, counts, extremes, and on demand its trajectory.
#ifndef TETLAP_FEM_RUN_RESULT_RUN_RESULT_H
#define TETLAP_FEM_RUN_RESULT_RUN_RESULT_H

#include "base/files/record.h"
#include "contact/evaluation.h"
#include "contact/status.h"
#include "fem/output/trouble.h"
#include "fem/statics/statics.h"
#include "fem/time/audit.h"
#include "fem/time/integrator.h"

// `contact`: candidate lists, pressures and forces, without broad phase and overlap volumes. `products`: of
// the matrix, and vectors of conjugate gradients. `integration`: the integrator's vectors, Newton's method,
// states under trial. `measures`: audits, momentum, trouble. What no phase names is the difference to the
// total. All of them wall [s].
typedef struct FemRunPhases {
  double start, broad_phase, overlap, contact, forces, layout, assembly, analysis, factorisation, solve,
      products, integration, measures, output, total;
} FemRunPhases;

enum { FEM_RUN_DESCRIBED_COUNT = 3, FEM_RUN_SPREAD_COUNT = 18 };

// Over the ranks that shared the run, of what the names say.
typedef struct FemRunSpread {
  int rank_count; // 0: one process
  double least[FEM_RUN_SPREAD_COUNT], mean[FEM_RUN_SPREAD_COUNT], most[FEM_RUN_SPREAD_COUNT];
} FemRunSpread;

typedef struct FemRunCost {
  double wall_s, cpu_s;
  double work_s; // processor time outside of MPI
  size_t peak_rss_bytes;
  FemRunPhases phases;
} FemRunCost;

typedef struct FemRunMatrix {
  const char *solver_name;
  FemSolverStats solver;
  long long assemblies; // of K, or K and D apart: how often the elements' matrices were added up
  long long layouts;    // how often the pattern was laid out
} FemRunMatrix;

// Steps that were taken back.
typedef struct FemRunRetries {
  long long energy;   // they gained energy
  long long momentum; // forces and motion differed
  long long slip;     // friction acted along a slip that had reversed within them
} FemRunRetries;

typedef struct FemRunEnergy {
  FemAudit audit;
  FemAuditBounds bounds;
} FemRunEnergy;

typedef struct FemRunMomentum {
  double gap; // over the run, of the body where it is largest (fem/measure/momentum.h)
  int body;   // that body
} FemRunMomentum;

// Of the last equilibrium of a static scene, and on the way there.
typedef struct FemRunEquilibrium {
  double residual, residual_allowed; // largest force on an unknown [N]
  long long relaxation_steps, halvings, loose;
  FemStability stability;
} FemRunEquilibrium;

typedef struct FemRunContact {
  bool is_on, asks_model;     // whether any of it asks an overlap model
  ContactPairCounts pairs;    // handed to the overlap model
  int pairs_max;              // pairs with V > 0, the most at a time
  double overlap_volume_max;  // [m³]
  double deepest_overlap_max; // largest share of an element that was covered
  double force_max;           // of an interface [N]
  double force_last;          // the largest at the last frame [N]
  double force_since_row;     // the largest in the steps since the last row of the history [N]
} FemRunContact;

typedef struct FemRunStatus {
  bool is_asked;             // by the scene: who overlaps
  ContactStatusCounts pairs; // summed over the frames
} FemRunStatus;

// Bodies that lie inside of each other at the end of the run.
typedef struct FemRunInside {
  int count;   // elements
  int element; // the first of them
  int parties[2];
} FemRunInside;

typedef struct FemRunAccount {
  Record *record; // contacts and probes as in summary.json, owned; NULL: the run has not begun
  // The pairs of bodies that pressed hardest, described with the error of contact
  char contacts[FEM_RUN_DESCRIBED_COUNT][1024]; //                               (contact_count)
  int contact_count;
} FemRunAccount;

// With keep_trajectory.
typedef struct FemRunTrajectory {
  int frame_count, vertex_count, interface_count;
  char **interface_names;   // "a, b", owned                       (interface_count)
  double *times;            //                                     (frame_count)
  double *positions;        // [m]                                 (frame_count, vertex_count, 3)
  double *interface_forces; // on the first side [N]               (frame_count, interface_count, 3)
} FemRunTrajectory;

// Counts of a part of the run between two checkpoints are added to those before. A number that is added here
// goes into numbers[] in fem/run/checkpoint/numbers.c as well.
typedef struct FemRunResult {
  double end_time; // reached [s]
  bool is_static;
  int state_unknowns; // displacements, and in a motion as many velocities
  double min_det_F;
  FemRunCost cost;
  FemIntegratorStats integrator;
  FemRunMatrix matrix;
  FemRunRetries retries;
  FemRunEnergy energy;
  FemRunMomentum momentum;
  FemRunEquilibrium equilibrium;
  FemRunContact contact;
  FemRunStatus status;
  FemTrouble trouble;
  FemRunInside inside;
  FemRunSpread spread; // since this process began
  Record *counters;    // owned
  FemRunAccount account;
  FemRunTrajectory trajectory;
  int effect_count; // those that the scene called for
  struct {
    const char *name; // borrowed
    FemEffectCost cost;
  } effects[FEM_MAX_EFFECTS]; //                                  (effect_count)
} FemRunResult;

// Adds what a system and a solver have counted since they were made. `contact` of the phases is what effects
// took to prepare, without the broad phase.
void fem_run_result_add_system(FemRunResult *result, const FemSystem *system);
void fem_run_result_add_phases(FemRunPhases *phases, const FemSystem *system);
double fem_run_result_named_s(const FemRunPhases *phases); // the sum of all but the total
void fem_run_result_add_integrator(FemIntegratorStats *total, const FemIntegratorStats *part);
void fem_run_result_add_solver(FemSolverStats *total, const FemSolverStats *part);
void fem_run_result_destroy(FemRunResult *result);

// "finished", "interrupted" or "failed"; "passed through": bodies did, or would have in the step with which
// it ended; "inside each other": they lie so at the end.
const char *fem_run_outcome(const FemRunResult *result, Status status);

// The bodies that lie inside of each other, on one line.
void fem_run_describe_inside(const FemRunInside *inside, const FemModel *model, char *text, size_t size);
// Of a run that failed with `status` and the thread's message. Where the overlap model gave volumes that
// cannot be, the message says so, too. Returns `status`.
Status fem_run_result_blame_model(const FemRunResult *result, Status status);
// The trouble that occurred, three lines each: what, where, what to do; or "none". `model`: the one that ran.
void fem_run_describe_trouble(const FemRunResult *result, const FemModel *model, char *text, size_t size);
// Extremes and counts that need no action, a line each.
void fem_run_describe_statistics(const FemRunResult *result, char *text, size_t size);

// summary.json of a run.
void fem_run_summarise(const FemRunResult *result, Record *summary);

#endif
