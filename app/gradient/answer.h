// SPDX-License-Identifier: GPL-3.0-or-later
// What a gradient is asked, in words, and what a run of a scene answers.
#ifndef TETLAP_APP_GRADIENT_ANSWER_H
#define TETLAP_APP_GRADIENT_ANSWER_H

#include <signal.h>

#include "fem/gradient/path/path.h"

enum { APP_GRADIENT_MOST = 64 }; // goals; parameters

typedef struct AppGradientWords {
  const char *of[APP_GRADIENT_MOST]; // app/gradient/goal.h
  const char *by[APP_GRADIENT_MOST]; // app/gradient/parameter.h
  int of_count, by_count;
  double at;             // when goals are taken that name no time [s]; 0: at the run's end
  double most_megabytes; // that the replay of a path may keep; 0: what there is
  bool by_weights;       // of the overlap model's network, too
  bool is_total;         // a contact stiffness that is chosen follows E and ν
} AppGradientWords;

typedef struct AppGradientAnswer {
  FemGoal goals[APP_GRADIENT_MOST];
  FemParameter parameters[APP_GRADIENT_MOST];
  FemGradientDef def;
  FemReplaySteps steps; // of a path
  FemGradient gradient;
} AppGradientAnswer;

// Runs the scene and differentiates. What can be refused is refused before the run: STATUS_INPUT. `stop` ends
// the run and its replay. Destroy the answer also after a failure.
Status app_gradient_answer(AppGradientAnswer *answer, const FemModel *model, const AppGradientWords *words,
                           const volatile sig_atomic_t *stop);
void app_gradient_answer_destroy(AppGradientAnswer *answer);

// The memory that a replay may take, rounded to whole bytes [B]. Of 0 it is 0, which sets no limit; of
// anything more at least 1, and at most SIZE_MAX.
size_t app_gradient_bytes(double megabytes);

// What a derivative does with the contact stiffness, in a word: "none" (there is no contact), "given" (by the
// scene), "kept" (chosen, and held as E and ν vary) or "follows" (chosen, and chosen anew as they vary).
const char *app_gradient_stiffness(const FemModel *model, const AppGradientWords *words);

#endif
