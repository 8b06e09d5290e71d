// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of paths against central differences of replays with the same steps.
#ifndef TETLAP_TESTS_REPLAYS_H
#define TETLAP_TESTS_REPLAYS_H

#include "answer.h"
#include "fem/gradient/path/check.h"
#include "fem/gradient/path/path.h"
#include "fem/gradient/path/replay.h"

typedef struct Asked {
  const char *scene, *setting;
  const char *overlap;             // another setting; NULL: none
  const char *of[MOST], *by[MOST]; // ended by NULL
  double tolerance;                // relative to g/p, or to dg/dp where that is more; 0: 1e-6
  double step;                     // of the differences, relative; 0: 1e-4
  bool is_forward;                 // their points are on one side
  bool by_weights;
  int least_steps;          // of the run; 0: 20
  long long least_switches; // between sticking and slipping
  long long least_yields;   // between elastic and yielding
} Asked;

static inline Status record(void *observer, const FemRunProgress *progress) {
  FemReplaySteps *steps = observer;
  return fem_replay_steps_add(steps, progress->system);
}

// The steps of the scene as it is.
static inline void find_steps(const Asked *asked, FemReplaySteps *steps) {
  SceneRun scene;
  FemGoal goals[MOST];
  int count = 0;
  *steps = (FemReplaySteps){0};
  scene_open(&scene, asked->scene, (const char *const[]){asked->setting, asked->overlap, NULL});
  for (const char *const *of = asked->of; *of; of++)
    ck_assert_ok(app_gradient_read_goal(&scene.model, *of, INFINITY, &goals[count++]));
  FemRunOptions options = {.observe = record, .observer = steps};
  ck_assert_ok(app_gradient_run(&scene.model, &(FemGradientDef){.goals = goals, .goal_count = count},
                                &options, &scene.result));
  for (int g = 0; g < count; g++) app_gradient_destroy_goal(&goals[g]);
  scene_close(&scene);
}

static inline void replay(const Asked *asked, const FemReplaySteps *steps, const char *override,
                          bool with_parameters, Answer *answer) {
  SceneRun scene;
  *answer = (Answer){0};
  scene_open(&scene, asked->scene,
             asked->overlap ? (const char *const[]){asked->setting, asked->overlap, override, NULL}
                            : (const char *const[]){asked->setting, override, NULL});
  for (const char *const *of = asked->of; *of; of++)
    ck_assert_ok(app_gradient_read_goal(&scene.model, *of, INFINITY, &answer->goals[answer->goal_count++]));
  for (const char *const *by = asked->by; *by && with_parameters; by++) {
    FemParameter *parameter = &answer->parameters[answer->parameter_count];
    ck_assert_ok(app_gradient_read_parameter(&scene.model, *by, parameter));
    answer->values[answer->parameter_count++] = fem_parameter_value(&scene.model, parameter);
  }
  const FemGradientDef def = {answer->goals,
                              answer->parameters,
                              answer->goal_count,
                              answer->parameter_count,
                              false,
                              asked->by_weights && with_parameters};
  ck_assert_ok(fem_path_check(&scene.model, &def));
  ck_assert_ok(fem_path_differentiate(&answer->gradient, &scene.model, &def, steps, NULL));
  scene_close(&scene);
}

// p ∂g/∂p of every goal by differences of the fourth order, forwards of the third.
static inline void differ(const Asked *asked, const FemReplaySteps *steps, const char *key, double middle,
                          double size, double shares[MOST]) {
  static const double places[2][4] = {{-2, -1, 1, 2}, {0, 1, 2, 3}};
  static const double weights[2][4] = {{1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12},
                                       {-11.0 / 6, 3, -3.0 / 2, 1.0 / 3}};
  double step = asked->step > 0 ? asked->step : 1e-4;
  memset(shares, 0, MOST * sizeof *shares);
  for (int k = 0; k < 4; k++) {
    char override[256];
    Answer answer;
    snprintf(override, sizeof override, "%s=%.17g", key, middle + places[asked->is_forward][k] * step * size);
    replay(asked, steps, override, false, &answer);
    for (int g = 0; g < answer.goal_count; g++)
      shares[g] += weights[asked->is_forward][k] / step * answer.gradient.values[g];
    destroy(&answer);
  }
}

// Relative to g/p, or to the derivative where that is more.
static inline void check_against_replays(const Asked *asked) {
  static const double OF_ZERO = 1e-2;
  const double tolerance = asked->tolerance > 0 ? asked->tolerance : 1e-6;
  FemReplaySteps steps;
  Answer answer;
  find_steps(asked, &steps);
  ck_assert_int_gt(steps.count, asked->least_steps > 0 ? asked->least_steps : 20);
  replay(asked, &steps, NULL, true, &answer);
  ck_assert_double_le(answer.gradient.unbalanced, 1e-9);
  ck_assert_int_ge(answer.gradient.switches, asked->least_switches);
  ck_assert_int_ge(answer.gradient.yields, asked->least_yields);
  for (int p = 0; p < answer.parameter_count; p++) {
    double shares[MOST], size = answer.values[p] != 0 ? fabs(answer.values[p]) : OF_ZERO;
    differ(asked, &steps, asked->by[p], answer.values[p], size, shares);
    for (int g = 0; g < answer.goal_count; g++) {
      double found = answer.gradient.derivatives[g * answer.parameter_count + p] * size;
      double whole = fmax(fabs(answer.gradient.values[g]), fabs(found));
      ck_assert_double_le(answer.gradient.residuals[g], 1e-9);
      ck_assert_double_gt(fabs(found), 0); // of bodies that never met, it were 0 by contact.stiffness
      ck_assert_msg(fabs(found - shares[g]) <= tolerance * whole,
                    "%s by %s: p dg/dp = %.12g, replays %.12g, g = %.6g", asked->of[g], asked->by[p], found,
                    shares[g], answer.gradient.values[g]);
    }
  }
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}

#endif
