// SPDX-License-Identifier: GPL-3.0-or-later
// What the author of a scene may not have meant: notes of `tetlap check`, a sentence each.
#ifndef TETLAP_APP_COMMAND_SCENE_CHECK_NOTES_H
#define TETLAP_APP_COMMAND_SCENE_CHECK_NOTES_H

#include "app/job/job.h"
#include "fem/run/check/start.h"

enum { APP_CHECK_NOTES = 32, APP_CHECK_THIN = 6, APP_CHECK_LINES = 6, APP_CHECK_SEAMS = 4 };

typedef struct AppCheckNotes {
  const char *texts[APP_CHECK_NOTES]; // of the program or in the arrays below   (count)
  int count;
  char overlaps[FEM_RUN_START_TOLD_COUNT][FEM_RUN_START_TEXT_SIZE];
  char thin[APP_CHECK_THIN][512];
  char crushed[512], far_larger[512];
  char lines[APP_CHECK_LINES][256], seams[APP_CHECK_SEAMS][256];
} AppCheckNotes;

// Takes the notes where they are to stay: `texts` points into them. The Status of the first evaluation of
// contact that fails, or STATUS_MEMORY.
Status app_check_notes_take(const AppJob *job, AppCheckNotes *notes);

// The box around a body as placed, at rest [m].
void app_check_notes_box(const FemModel *model, const FemModelBody *body, double low[3], double high[3]);

#endif
