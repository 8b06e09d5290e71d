// SPDX-License-Identifier: GPL-3.0-or-later
// What was done to a run from outside, as text. A line of JSON stands for each thing that was set, each
// advance, and each time that a state was kept, because the integrator begins anew there. Whoever does the
// same again, line by line, gets the same run to the last bit (`tetlap run --replay`).
//
//   {"format": 1, "vertices": 1234}
//   {"drive": "finger", "to": [0, 0, -0.001], "ramp": null}     ramp null: until the next advance ends
//   {"load": "ball", "to": [0, 0, 1], "ramp": 0}
//   {"advance": 0.01}                                           with "stopped": where a condition ended it
//   {"anew": true}
#ifndef TETLAP_APP_LOOP_DIARY_H
#define TETLAP_APP_LOOP_DIARY_H

#include "app/loop/groups.h"
#include "base/files/record.h"

enum { APP_LOOP_DIARY_FORMAT = 1 };

typedef struct AppLoopDiary {
  char *text; // owned, ends with 0                                               (size + 1)
  size_t size, capacity;
} AppLoopDiary;

// With its first line.
Status app_loop_diary_create(AppLoopDiary *diary, int vertex_count);
void app_loop_diary_destroy(AppLoopDiary *diary); // also of a zeroed one

Status app_loop_diary_set(AppLoopDiary *diary, AppLoopKind kind, const char *name, double ramp,
                          const double *values, int count);
// `stopped` [s]: where it ended; at `until`, or before.
Status app_loop_diary_advance(AppLoopDiary *diary, double until, double stopped);
Status app_loop_diary_anew(AppLoopDiary *diary);

// The whole text as a file. STATUS_IO.
Status app_loop_diary_write(const AppLoopDiary *diary, const char *path);

Status app_loop_diary_copy(AppLoopDiary *copy, const AppLoopDiary *diary); // `copy`: zeroed, or a diary

#endif
