// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is stopped at a checkpoint, and one that is killed with SIGKILL between two, go on to the same
// bits as the uninterrupted run.
#ifndef TETLAP_APP_STRESS_RESUME_H
#define TETLAP_APP_STRESS_RESUME_H

#include "app/stress/run.h"

// Runs three times, writing into a folder of its own under $TMPDIR that is removed afterwards; run->extra
// keeps what differs.
Status app_stress_resume_run(AppStressRun *run);
void app_stress_resume_judge(const AppStressRun *run, AppStressRow *row);

#endif
