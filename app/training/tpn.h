// SPDX-License-Identifier: GPL-3.0-or-later
// Training of a TetrahedronPairNet, as published or after it; the task itself is listed in task.h.
#ifndef TETLAP_APP_TRAINING_TPN_H
#define TETLAP_APP_TRAINING_TPN_H

#include "app/training/config.h"
#include "overlap/pair/range.h"

// The range of a configuration's training pairs: makes or reads all of them.
Status app_training_tpn_range(const AppTrainingConfig *config, OverlapRange *range);

#endif
