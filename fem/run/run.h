// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run of a scene: model → system → integrator (in a static scene fem/statics/statics.h) → frames.
//
//     one step (run_step.h) ─► accept: effects renew their lists (run_stage.h)
//       ▲                                  │
//       ├──── other unknowns: new stage ◄──┤
//       └──── system and integrator begin anew from the checkpoint (checkpoint.h) ◄── when one is due
//
// A checkpoint is due after so many frames, whatever the clock says, so that two runs of a scene are the
// same; the clock only says whether it is written to checkpoint.h5. A run that is stopped, or that fails
// because nothing can be written or allocated, leaves its last checkpoint there; one that reaches its end,
// none.
#ifndef TETLAP_FEM_RUN_RUN_H
#define TETLAP_FEM_RUN_RUN_H

#include "fem/run/result/run_result.h"
#include "fem/run/run_options.h"

// Runs the model to its end. `result` is filled as far as the run came also when it fails; destroy it always.
Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result);
#endif
