// SPDX-License-Identifier: GPL-3.0-or-later
// What is differentiated, as a word of a command line: a quantity, or `sum:FILE` and `misfit:FILE`: a line
// for each term, "quantity, weight" or "quantity, weight, data"; empty lines and those that begin with # are
// left out. A quantity is followed by the time when it is taken, as in "energy@0.02", or taken `at` a time;
// INFINITY: at the run's end.
#ifndef TETLAP_APP_GRADIENT_GOAL_H
#define TETLAP_APP_GRADIENT_GOAL_H

#include "fem/gradient/quantity.h"

// Destroy the goal also after a failure. STATUS_INPUT names the file's line.
Status app_gradient_read_goal(const FemModel *model, const char *text, double at, FemGoal *goal);
void app_gradient_destroy_goal(FemGoal *goal); // also of a zeroed one
// That of a quantity; of a sum and a misfit "", since terms may differ.
const char *app_gradient_unit(const FemGoal *goal, const char *text);

#endif
