// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of static scenes, found by a run of a scene of tests/scenes or of a text.
#ifndef TETLAP_TESTS_EQUILIBRIA_H
#define TETLAP_TESTS_EQUILIBRIA_H

#include "answer.h"
#include "folder.h"

// What is asked of a scene.
typedef struct Asked {
  const char *scene; // of tests/scenes, or a text
  bool is_text;
  const char *setting;             // of the scene; NULL: as it is
  const char *of[MOST], *by[MOST]; // ended by NULL
  bool follows, by_weights;
} Asked;

static inline Status at_end(void *observer, const FemRunProgress *progress) {
  Answer *answer = observer;
  bool is_due = false;
  for (int g = 0; g < answer->goal_count; g++)
    is_due = is_due || fem_goal_is_due(&answer->goals[g], progress->system->model, progress->time);
  if (!is_due || progress->time <= answer->gradient.time) return STATUS_OK;
  answer->is_done = true;
  return fem_gradient_find(&answer->gradient, progress->system, &answer->def);
}

static inline Status read_words(const Asked *asked, const FemModel *model, Answer *answer) {
  for (const char *const *of = asked->of; *of; of++)
    TRY(app_gradient_read_goal(model, *of, INFINITY, &answer->goals[answer->goal_count++]));
  for (const char *const *by = asked->by; *by; by++) {
    FemParameter *parameter = &answer->parameters[answer->parameter_count];
    TRY(app_gradient_read_parameter(model, *by, parameter));
    answer->idle[answer->parameter_count] = fem_parameter_idle(model, parameter);
    answer->values[answer->parameter_count++] = fem_parameter_value(model, parameter);
  }
  answer->def = (FemGradientDef){answer->goals,           answer->parameters, answer->goal_count,
                                 answer->parameter_count, asked->follows,     asked->by_weights};
  return fem_gradient_check(model, &answer->def);
}

// Refusals come before the run.
static inline Status run(const Asked *asked, const char *override, Answer *answer) {
  SceneRun scene;
  *answer = (Answer){0};
  if (asked->is_text)
    scene_open_text(&scene, asked->scene);
  else
    scene_open(&scene, asked->scene,
               asked->setting ? (const char *const[]){asked->setting, override, NULL}
                              : (const char *const[]){override, NULL});
  FemRunOptions options = {.observe = at_end, .observer = answer};
  Status status = read_words(asked, &scene.model, answer);
  if (!status) status = app_gradient_run(&scene.model, &answer->def, &options, &scene.result);
  scene_close(&scene);
  return status;
}

// A file of a sum or a misfit in the test's folder; `word` names it as a goal.
static inline void write_file(const char *name, const char *text, char word[256], const char *kind) {
  char path[200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  ck_assert_int_eq(fclose(file), 0);
  snprintf(word, 256, "%s:%s", kind, path);
}

#endif
