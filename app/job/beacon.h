// SPDX-License-Identifier: GPL-3.0-or-later
// How far a run is, in its folder, for those who watch it. progress.json is written a few times a minute at
// least and once a second at most, manifest.json as soon as there is something to see. The former goes when
// the run ends; one that is left behind names a process that is gone.
#ifndef TETLAP_APP_JOB_BEACON_H
#define TETLAP_APP_JOB_BEACON_H

#include "app/job/job.h"

#define APP_BEACON_FILE "progress.json"

typedef struct AppBeacon {
  const AppJob *job; // borrowed
  double began_s, told_s;
  double began_time; // of the scene, where this process began [s]
  bool is_lit;
} AppBeacon;

AppBeacon app_beacon_begin(const AppJob *job);

// After every accepted step. STATUS_IO, STATUS_MEMORY.
Status app_beacon_show(AppBeacon *beacon, const FemRunProgress *progress);

void app_beacon_end(AppBeacon *beacon);

#endif
