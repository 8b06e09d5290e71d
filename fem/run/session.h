// SPDX-License-Identifier: GPL-3.0-or-later
// A run that the caller steps. It goes on to a time that the caller gives. In between its state can be read,
// and it can be taken back to any state that was kept.
//
//   open ─► advance ─► read ─► (change what is prescribed) ─► advance ─► … ─► close
//               ▲        keep ─► checkpoint ─► restore │
//               └──────────────────────────────────────┘
//
// Steps are those of fem_run, but one ends at each time that the caller asks for. One call to the end is
// fem_run, to the last bit.
#ifndef TETLAP_FEM_RUN_SESSION_H
#define TETLAP_FEM_RUN_SESSION_H

#include "fem/run/run.h"
#include "fem/run/run_state.h"

typedef struct FemRunSession FemRunSession;

// Begins at options->from, or at the start. `model`, `options` and `result` are borrowed until it is closed;
// the caller destroys the result. After a failure *session is NULL.
Status fem_run_session_open(FemRunSession **session, const FemModel *model, const FemRunOptions *options,
                            FemRunResult *result);

// Steps until `time` [s], or until fem_run_session_stop. The state is then the one that was accepted last.
// Once it has failed, it fails with the same message until a state is restored. STATUS_INPUT: the time lies
// before the run's, or beyond its end.
Status fem_run_session_advance(FemRunSession *session, double time);

// Whether it may go on to that time; fails as the next does.
Status fem_run_session_check(const FemRunSession *session, double time);

// For the run's observer: back to the accepted state, which a frame within the step may have taken the place
// of.
Status fem_run_session_look(FemRunSession *session);
// Likewise: the advance ends with this step.
void fem_run_session_stop(FemRunSession *session);
// Whether it did so in the last advance.
bool fem_run_session_is_stopped(const FemRunSession *session);

// What is prescribed from the run's time on has changed. `jumps`: forces do at that time, so the integrator
// begins anew; else only their rates.
Status fem_run_session_change(FemRunSession *session, bool jumps);

// Takes a checkpoint, which is copied, and begins anew from it; the copy is the caller's.
Status fem_run_session_keep(FemRunSession *session, FemCheckpoint *copy);
// Begins anew from a checkpoint of this model. What follows is the same, to the last bit, as what followed
// where it was kept.
Status fem_run_session_restore(FemRunSession *session, const FemCheckpoint *from);

// The run as it stands; its `trial` is the accepted state, at which contact has been evaluated.
const FemRunState *fem_run_session_state(const FemRunSession *session);

// Ends the run, at its end or before; NULL: nothing. `status`: OK, or that of the last advance.
Status fem_run_session_close(FemRunSession *session, Status status);

#endif
