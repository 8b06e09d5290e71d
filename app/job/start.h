// SPDX-License-Identifier: GPL-3.0-or-later
// `start` of a scene: the end state of another run, which the model starts with.
#ifndef TETLAP_APP_JOB_START_H
#define TETLAP_APP_JOB_START_H

#include "base/files/record.h"
#include "fem/model/model.h"

// Reads the end state that the scene names, gives it to the model, and adds its digest to `inputs`, the run's
// own (app/job/inputs.h); without `start` it does nothing. `directory`: where the run will write.
// STATUS_INPUT names the folder and what is missing or differs: its outcome, bodies, meshes, elements, who
// yields.
Status app_start_read(FemModel *model, const char *directory, Record *inputs);

#endif
