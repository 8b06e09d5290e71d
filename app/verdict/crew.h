// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the tasks of verdicts side by side, as child processes (app/sweep/child.h).
#ifndef TETLAP_APP_VERDICT_CREW_H
#define TETLAP_APP_VERDICT_CREW_H

#include <signal.h>

#include "app/verdict/tasks.h"

// Runs what is not there yet of all plans, `jobs` at once. A task whose process fails leaves its log, and the
// verdict says that it has nothing from it. STATUS_INTERRUPTED: stopped; the same call goes on with the rest.
Status app_verdict_crew_run(const AppVerdictPlan *plans, int plan_count, int jobs,
                            const volatile sig_atomic_t *stop);

#endif
