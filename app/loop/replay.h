// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is set from outside as a file says, which a run that was stepped has left (app/loop/diary.h).
#ifndef TETLAP_APP_LOOP_REPLAY_H
#define TETLAP_APP_LOOP_REPLAY_H

#include "app/job/job.h"

// fem_run with these settings, whose times it steps to; beyond the last of them it goes on to the scene's
// end. STATUS_INPUT names the line that is wrong, or that this scene has no group for.
Status app_loop_replay(AppJob *job, const FemRunOptions *options, FemRunResult *result, const char *path);

#endif
