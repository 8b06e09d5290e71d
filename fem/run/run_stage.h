// SPDX-License-Identifier: GPL-3.0-or-later
// A stage of a run: from one change of what is free to the next. An integrator lasts for a stage.
#ifndef TETLAP_FEM_RUN_RUN_STAGE_H
#define TETLAP_FEM_RUN_RUN_STAGE_H

#include "fem/run/run_state.h"

// A share of the time in which a wave crosses an element: no shorter step is tried again [s].
double fem_run_stage_resolved(const FemModel *model);

// The same of the time in which contact throws an element back, if that is shorter: no shorter step is tried
// again for its energy [s]. A contact whose pressure rises by p′ per overlap has the modulus h p′ for an
// element of the edge h, as a wave has E; p′ of a law where it presses with E.
double fem_run_stage_rebound(const FemModel *model, const ContactLayout *contact);

// The last accepted state, under trial.
void fem_run_stage_scatter(FemRunState *run);

// The integrator of the stage that begins at the run's time with u and v, none where all bodies sleep; `step`
// [s] is tried first, 0: chosen.
Status fem_run_stage_begin(FemRunState *run, double step);

// Counts what the integrator, or statics, has done, and destroys it.
void fem_run_stage_end(FemRunState *run);

// Vertices come free, bodies fall asleep or awake: the next stage, with other unknowns.
Status fem_run_stage_change(FemRunState *run);

// The run's state is accepted; `next_step` [s] is the expected length of the next one.
Status fem_run_stage_accept(FemRunState *run, double next_step);

#endif
