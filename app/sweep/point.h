// SPDX-License-Identifier: GPL-3.0-or-later
// A point of a sweep's grid: what is set there, the folder of its run, and what came of it.
#ifndef TETLAP_APP_SWEEP_POINT_H
#define TETLAP_APP_SWEEP_POINT_H

#include <stdbool.h>
#include <stddef.h>

#include "app/sweep/axis.h"
#include "app/sweep/history.h"
#include "base/files/record.h"

#define APP_SWEEP_LOG "log.txt" // in a point's folder: what its processes print, one after another

enum {
  APP_SWEEP_MAX_AXES = 8,
  APP_SWEEP_MAX_POINTS = 10000,
  APP_SWEEP_FOLDER = 128,
  APP_SWEEP_MAX_REPEATS = 100
};

// What all points share; all borrowed but the axes, which belong to the sweep.
typedef struct AppSweepBase {
  const char *scene_path, *directory;
  const char *overlap; // in place of the scene's; NULL: the scene's own
  const char *const *overrides;
  int override_count;
  AppSweepAxis axes[APP_SWEEP_MAX_AXES];
  int axis_count;
  int repeat_count; // runs of each combination of values, for times
} AppSweepBase;

typedef enum AppSweepState {
  APP_SWEEP_WAITING,   // to be begun
  APP_SWEEP_RESUMABLE, // to be gone on with from its checkpoint
  APP_SWEEP_RUNNING,
  APP_SWEEP_FINISHED,
  APP_SWEEP_FAILED,
} AppSweepState;

typedef struct AppSweepPoint {
  int values[APP_SWEEP_MAX_AXES];     // of each axis, by number
  char *settings[APP_SWEEP_MAX_AXES]; // "key=value" (axis_count), owned
  int repeat;                         // which run of its values, from 0
  char folder[APP_SWEEP_FOLDER];      // below the sweep's: its values
  char *directory;                    // owned
  AppSweepState state;
  int exit_code;            // of a point that has ended
  size_t log_begin;         // where its log begins to tell of the process that was started last
  char message[512];        // why it failed
  Record *summary;          // summary.json, owned; NULL: none
  AppSweepHistory *history; // of one that has ended, owned; NULL: none
} AppSweepPoint;

int app_sweep_point_count(const AppSweepBase *base); // of the grid; more than MAX_POINTS: too many

// Point `index` of the grid, the last axis fastest, repeats slowest: so repeats take turns.
Status app_sweep_point_create(AppSweepPoint *point, const AppSweepBase *base, int index);
void app_sweep_point_destroy(AppSweepPoint *point);

// What an earlier sweep left of it, if scene, meshes and weights are the same: finished, to be resumed, or to
// be run. One that the solver gave up stays failed, unless `again`. `before` is the earlier sweep.json (NULL:
// none). STATUS_USAGE, STATUS_INPUT: no such scene; then the point has failed, with the message.
Status app_sweep_point_examine(AppSweepPoint *point, const AppSweepBase *base, const Record *before,
                               bool again);

// Reads what its run has left when the process has ended with `exit_code`.
void app_sweep_point_conclude(AppSweepPoint *point, int exit_code);

#endif
