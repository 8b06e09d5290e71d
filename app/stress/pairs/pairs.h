// SPDX-License-Identifier: GPL-3.0-or-later
// Every class of hard pairs (datagen/hard.h) with every overlap model.
#ifndef TETLAP_APP_STRESS_PAIRS_PAIRS_H
#define TETLAP_APP_STRESS_PAIRS_PAIRS_H

#include "app/stress/stress.h"

Status app_stress_pairs_run(const AppStressOptions *options, AppStress *stress);

#endif
