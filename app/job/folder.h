// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run that is refused before its first step: what the run made of it goes again.
#ifndef TETLAP_APP_JOB_FOLDER_H
#define TETLAP_APP_JOB_FOLDER_H

#include <stdbool.h>

#include "base/status.h"
#include "fem/run/run.h"

// How many folders of the path, from its end on, are not there yet.
int app_job_folder_missing(const char *directory);

// Whether a run that ended so was refused: its input was wrong, and no step was taken.
bool app_job_folder_is_refused(Status status, const FemRunResult *result);

// Removes the files in a folder that was missing, the folder, and those above it that were missing and are
// empty: `missing` in all. 0: nothing.
void app_job_folder_remove(const char *directory, int missing);

#endif
