// SPDX-License-Identifier: GPL-3.0-or-later
// A state of a run that is stepped, from which it, or another process with the same scene, goes on to the
// same bits: a checkpoint (fem/run/checkpoint/checkpoint.h), what was set from outside, impulses, and the
// diary.
#ifndef TETLAP_APP_LOOP_STATE_H
#define TETLAP_APP_LOOP_STATE_H

#include "app/loop/loop.h"

typedef struct AppLoopState {
  FemCheckpoint checkpoint;
  double *values; // of the groups (app_loop_groups_save), then 3 of each contact's impulse; owned    (count)
  size_t count;
  AppLoopDiary diary;
} AppLoopState;

// Keeps the present state; the run begins its integrator anew there. After a failure, and of a zeroed one, it
// can be destroyed.
Status app_loop_state_keep(AppLoop *loop, AppLoopState *state);
void app_loop_state_destroy(AppLoopState *state);

// STATUS_INPUT: it is of another scene.
Status app_loop_state_restore(AppLoop *loop, const AppLoopState *state);

// To a file, and back. STATUS_INPUT: the file is none, or of another scene, program, mesh or weights.
Status app_loop_state_write(const AppLoop *loop, const AppLoopState *state, const char *path);
Status app_loop_state_read(const AppLoop *loop, AppLoopState *state, const char *path);

#endif
