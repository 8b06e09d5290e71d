// SPDX-License-Identifier: GPL-3.0-or-later
// A run while it goes on, shared by the files that make it up, and for those only:
//   run.c         begins, marches and ends, and begins anew at checkpoints
//   run_stage.c   begins anew where what is free changes
//   run_step.c    a step of a motion
//   run_load.c    a step of a static scene
//   run_frames.c  measures states and writes frames
//   run_watch.c   counts trouble and reports to the caller
//   checkpoint/   keeps what a resumed run needs
#ifndef TETLAP_FEM_RUN_RUN_STATE_H
#define TETLAP_FEM_RUN_RUN_STATE_H

#include "fem/output/recorder.h"
#include "fem/run/checkpoint/checkpoint.h"
#include "fem/run/rest/rest.h"
#include "fem/run/result/run_result.h"
#include "fem/run/run_options.h"
#include "fem/statics/statics.h"
#include "fem/time/integrator.h"
#include "fem/time/stall.h"

typedef struct FemRunState {
  const FemModel *model;        // borrowed
  const FemRunOptions *options; // borrowed
  FemRunResult *result;         // borrowed; counts of what is over: closed parts and stages
  FemSystem system;
  FemRest *rest;             // NULL: no body may sleep
  FemIntegrator *integrator; // NULL in a static scene
  FemStatics statics;        // of a static scene
  FemRecorder recorder;
  FemAudit audit;
  double time;           // of the last accepted state
  double *u, *v;         // the last accepted state         (unknown_count)
  double *u_new, *v_new; // the state that is proposed       (unknown_count)
  FemState trial;        // the state that was evaluated last; the integrator's, or statics', too
  FemState middle;       // of a step, scratch
  double *mean_velocity; // of a step, scratch           (unknown_count)
  double *halfway;       // displacements there, scratch     (unknown_count)
  int next_frame;
  double least_power;       // of the step that is proposed, dissipated at least; INFINITY: no doubt [W]
  double rebound;           // no shorter step is tried again for its energy (fem/run/run_stage.h) [s]
  double next_step;         // to be tried; 0: the integrator's choice [s]
  FemStall stall;           // over all stages
  double stage_end;         // the next release of vertices, change for what sleeps, or the end [s]
  double target;            // a step ends there at the latest; INFINITY: anywhere [s]
  FemCheckpoint checkpoint; // where this part began
  bool is_written;          // the file holds that checkpoint
  FemTrouble mesh_trouble;  // of the mesh itself, before anything moves
  // Clocks: of this part, time within MPI then (base/ranks.h), and when a checkpoint was written.
  double began_s, cpu_began_s, inside_began_s, written_s;
} FemRunState;

// Counted over all parts and stages.
FemIntegratorStats fem_run_state_stats(const FemRunState *run);

bool fem_run_state_has_ended(const FemRunState *run);

#endif
