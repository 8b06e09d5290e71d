// SPDX-License-Identifier: GPL-3.0-or-later
// The lines at the end of a run, for someone who sees them for the first time: one fact each with its unit,
// in blocks of a label. The last block is `trouble:`, which says what needs action.
#ifndef TETLAP_APP_JOB_CLOSING_H
#define TETLAP_APP_JOB_CLOSING_H

#include "app/job/job.h"

// Logs them, of a run that has ended well.
void app_closing_print(const AppJob *job, const FemRunResult *result);

#endif
