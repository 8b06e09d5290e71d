// SPDX-License-Identifier: GPL-3.0-or-later
// All hard cases: classes of pairs, then scenes.
#ifndef TETLAP_APP_STRESS_ALL_H
#define TETLAP_APP_STRESS_ALL_H

#include "app/stress/stress.h"

// Runs what is asked for. STATUS_USAGE: nothing has that name; STATUS_INTERRUPTED. A case that fails is a
// row, not a Status.
Status app_stress_all_run(const AppStressOptions *options, AppStress *stress);

#endif
