// SPDX-License-Identifier: GPL-3.0-or-later
// What a run comes to: times, counts, extremes, and on demand its trajectory.
#ifndef TETLAP_FEM_RUN_RUN_RESULT_H
#define TETLAP_FEM_RUN_RUN_RESULT_H

#include "base/files/record.h"
#include "contact/evaluation.h"
#include "contact/status.h"
#include "fem/output/trouble.h"
#include "fem/run/rest.h"
#include "fem/time/audit.h"
#include "fem/time/integrator.h"

// `contact`: candidate lists, pressures and forces, without broad phase and overlap volumes.
// What no phase names (the energy audit, the integrator's vectors) is the difference to the total.
// All of them wall [s].
typedef struct FemRunPhases {
  double broad_phase, overlap, contact, forces, assembly, analysis, factorisation, solve, output, total;
} FemRunPhases;

enum { FEM_RUN_TOLD_COUNT = 3, FEM_RUN_SPREAD_COUNT = 18 };

// Over the ranks that shared the run, of what the names say.
typedef struct FemRunSpread {
  int rank_count; // 0: one process
  double least[FEM_RUN_SPREAD_COUNT], mean[FEM_RUN_SPREAD_COUNT], most[FEM_RUN_SPREAD_COUNT];
} FemRunSpread;

// Counts of a part of the run between two checkpoints are added to those before. Whoever adds a number adds
// it to numbers[] in fem/run/checkpoint/numbers.c and to fem_run_result_add as well.
typedef struct FemRunResult {
  double wall_s, cpu_s;
  double work_s; // processor time outside of MPI
  FemRunPhases phases;
  FemIntegratorStats integrator;
  FemSolverStats solver;
  const char *solver_name;
  long long assemblies;       // of K, or K and D apart: how often the elements' matrices were added up
  long long pattern_layouts;  // how often the matrix pattern was laid out
  long long energy_retries;   // steps taken back because they gained energy
  long long momentum_retries; // … because forces and motion differed
  long long slip_retries;     // … because what slipped had turned within them
  FemAudit audit;
  FemAuditBounds energy_bounds;
  FemTrouble trouble;
  double end_time;                  // reached [s]
  bool has_status;                  // the scene asked who overlaps
  ContactStatusCounts status_pairs; // summed over the frames
  ContactPairCounts pairs;          // handed to the overlap model over the whole run
  bool has_contact, asks_model;     // of contact; whether any of it asks an overlap model
  int state_unknowns;               // displacements, and in a motion as many velocities
  bool is_static;
  double residual, residual_allowed; // of the last equilibrium: largest force on an unknown [N]
  long long relaxation_steps, halvings, loose;
  int pairs_max;
  double overlap_volume_max, contact_force_max, min_det_F, deepest_overlap_max;
  double peak_since_row;     // largest interface force in the steps since the last row of the history [N]
  double momentum_gap;       // over the run, of the body where it is largest (fem/measure/momentum.h)
  int momentum_body;         // that body
  double last_contact_force; // largest interface force at the last frame [N]
  size_t peak_rss_bytes;
  FemRunSpread spread; // since this process began
  Record *counters;    // owned
  Record *account;     // contacts and probes as in summary.json, owned; NULL: the run has not begun
  // On each of the two that pressed most, lines that say how wrong they may be             (told_count)
  char told[FEM_RUN_TOLD_COUNT][512];
  int told_count;
  int effect_count; // those that the scene called for
  struct {
    const char *name; // borrowed
    FemEffectCost cost;
  } effects[FEM_MAX_EFFECTS]; //                                  (effect_count)
  // With keep_trajectory:
  int frame_count, vertex_count, interface_count;
  char **interface_names;   // "a, b", owned                       (interface_count)
  double *frame_times;      //                                     (frame_count)
  double *trajectory;       // positions [m]                       (frame_count, vertex_count, 3)
  double *interface_forces; // on the first side [N]               (frame_count, interface_count, 3)
} FemRunResult;

// Adds what a system and a solver have counted since they were made. `contact` of the phases is what effects
// took to prepare, without the broad phase.
void fem_run_result_add_system(FemRunResult *result, const FemSystem *system);
// Of bodies at rest; NULL: none may be.
void fem_run_result_add_rest(FemRunResult *result, const FemRest *rest);
void fem_run_result_add_integrator(FemIntegratorStats *total, const FemIntegratorStats *part);
void fem_run_result_add_solver(FemSolverStats *total, const FemSolverStats *part);
void fem_run_result_destroy(FemRunResult *result);

// "finished", "interrupted" or "failed"; "passed through": it reached its end, but bodies passed through each
// other.
const char *fem_run_outcome(const FemRunResult *result, Status status);

// What trouble struck, three lines each: what, where, what to do; or "none". `model`: the one that ran.
void fem_run_tell_trouble(const FemRunResult *result, const FemModel *model, char *text, size_t size);
// What happened and needs no action, a line each: restarts, retries, extremes.
void fem_run_tell_statistics(const FemRunResult *result, char *text, size_t size);

// As in summary.json: "elements", "cpu_s", …            (FEM_RUN_SPREAD_COUNT)
extern const char *const fem_run_spread_names[];

// summary.json of a run.
void fem_run_summarise(const FemRunResult *result, Record *summary);

#endif
