// SPDX-License-Identifier: GPL-3.0-or-later
// A run up to the last time at which a goal is taken; a step ends at each of those times.
#ifndef TETLAP_APP_GRADIENT_RUN_H
#define TETLAP_APP_GRADIENT_RUN_H

#include "fem/gradient/gradient.h"
#include "fem/run/run.h"

// As fem_run; without goals, to the end.
Status app_gradient_run(const FemModel *model, const FemGradientDef *def, const FemRunOptions *options,
                        FemRunResult *result);

#endif
