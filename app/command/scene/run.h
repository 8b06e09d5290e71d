// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap run SCENE`: runs a scene and writes its results.
#ifndef TETLAP_APP_COMMAND_SCENE_RUN_H
#define TETLAP_APP_COMMAND_SCENE_RUN_H

#include "app/cli/command.h"
#include "app/job/job.h"

typedef struct AppRunOptions {
  AppJobOptions job;
  const char *overlap, *capture; // NULL: the scene's; none
  const char *replay;            // what is set from outside (app/loop/replay.h); NULL: nothing
  bool is_strict;
  int rank_count;                   // --ranks; 0: not said
  const struct FemCheckpoint *from; // to go on from; NULL: from the start
  const char *from_path;            // its file
  const Record *origin;             // what it says of itself (app/job/origin.h)
} AppRunOptions;

// Opens the scene, runs it, writes summary and manifest; logs what went wrong.
Status app_run_execute(const AppRunOptions *options);

#endif
