// SPDX-License-Identifier: GPL-3.0-or-later
// How far a gradient is to be trusted, by other runs of its scene.
#ifndef TETLAP_APP_GRADIENT_CHECK_H
#define TETLAP_APP_GRADIENT_CHECK_H

#include "app/gradient/answer.h"
#include "app/job/job.h"

typedef struct AppGradientCheck {
  // |dg/dp with halved steps − dg/dp| / |dg/dp|; NaN: both are 0.
  double halved[APP_GRADIENT_MOST][APP_GRADIENT_MOST]; // (goals, parameters)
  // By how much g changes along a random direction, each parameter by up to one of itself: by the
  // derivatives, and by a difference of whole runs, whose steps are chosen anew. Parameters that are 0 stay,
  // rest positions (there is no --set of them), and what changes a contact stiffness that is chosen and kept;
  // NaN: all stay.
  double along[APP_GRADIENT_MOST], between[APP_GRADIENT_MOST]; // (goals)
} AppGradientCheck;

// Runs the scene of `job` three times more. In a motion a step's error is tightened so that steps are half as
// long, in a static scene there are twice as many frames.
Status app_gradient_check(AppGradientCheck *check, const AppJobOptions *job, const FemModel *model,
                          const AppGradientWords *words, const AppGradientAnswer *answer);

#endif
