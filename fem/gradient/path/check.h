// SPDX-License-Identifier: GPL-3.0-or-later
// What has derivatives at the end of a path of steps (fem/gradient/path/path.h).
#ifndef TETLAP_FEM_GRADIENT_PATH_CHECK_H
#define TETLAP_FEM_GRADIENT_PATH_CHECK_H

#include "fem/gradient/gradient.h"
#include "fem/gradient/path/replay_steps.h"

// Beyond fem_gradient_check. STATUS_INPUT: what cannot be differentiated in this scene; the message says what
// and why.
Status fem_path_check(const FemModel *model, const FemGradientDef *def);
// STATUS_INPUT: no step ends where a term is due; the message says when.
Status fem_path_check_times(const FemModel *model, const FemGradientDef *def, const FemReplaySteps *steps);

#endif
