// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of gradients ask, read into its parts, and what they are answered.
#ifndef TETLAP_TESTS_ANSWER_H
#define TETLAP_TESTS_ANSWER_H

#include "app/gradient/goal.h"
#include "app/gradient/parameter.h"
#include "app/gradient/run.h"
#include "fem/gradient/gradient.h"
#include "static_solve.h"

enum { MOST = 16 };

typedef struct Answer {
  int goal_count, parameter_count;
  FemGoal goals[MOST];
  FemParameter parameters[MOST];
  double values[MOST];    // of the parameters
  const char *idle[MOST]; // why a parameter changes nothing; NULL: it does
  FemGradientDef def;
  FemGradient gradient;
  bool is_done;
} Answer;

static inline void destroy(Answer *answer) {
  fem_gradient_destroy(&answer->gradient);
  for (int g = 0; g < answer->goal_count; g++) app_gradient_destroy_goal(&answer->goals[g]);
}

#endif
