// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/answer.h"

#include <math.h>

#include "app/gradient/goal.h"
#include "app/gradient/parameter.h"
#include "app/gradient/run.h"
#include "base/log.h"

static Status prepare(AppGradientAnswer *answer, const FemModel *model, const AppGradientWords *words) {
  double at = words->at > 0 ? words->at : INFINITY;
  answer->def = (FemGradientDef){.goals = answer->goals,
                                 .parameters = answer->parameters,
                                 .goal_count = words->of_count,
                                 .parameter_count = words->by_count,
                                 .by_weights = words->by_weights,
                                 .follows_choice = words->is_total};
  for (int g = 0; g < words->of_count; g++)
    TRY(status_prefix(app_gradient_read_goal(model, words->of[g], at, &answer->goals[g]), "--of"));
  for (int p = 0; p < words->by_count; p++)
    TRY(status_prefix(app_gradient_read_parameter(model, words->by[p], &answer->parameters[p]), "--by"));
  TRY(fem_gradient_check(model, &answer->def));
  return fem_gradient_is_path(model) ? fem_path_check(model, &answer->def) : STATUS_OK;
}

// Whether a goal is, at a state that was not seen before.
static bool is_taken(const AppGradientAnswer *answer, const FemRunProgress *progress) {
  bool is_due = false;
  for (int g = 0; g < answer->def.goal_count; g++)
    is_due = is_due || fem_goal_is_due(&answer->goals[g], progress->system->model, progress->time);
  return is_due && progress->time > answer->gradient.time;
}

static double megabytes_of(const AppGradientAnswer *answer) {
  static const double MEGABYTE = 1e6;
  return (double)answer->steps.bytes / MEGABYTE;
}

// A replay that would keep too much is refused as soon as the run shows it.
static Status add_step(AppGradientAnswer *answer, const FemRunProgress *progress) {
  TRY(fem_replay_steps_add(&answer->steps, progress->system));
  double kept = megabytes_of(answer), most = answer->most_megabytes;
  int count = answer->steps.count - 1;
  if (!(most > 0 && kept > most)) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "--memory: up to t = %.6g s, %d step%s, a replay keeps %.4g MB, more than %.4g MB; allow more, "
      "take goals at an earlier time (--at), or longer steps (time.tolerance, output.frames)",
      progress->time, count, count == 1 ? "" : "s", kept, most);
}

static Status at_step(void *observer, const FemRunProgress *progress) {
  AppGradientAnswer *answer = observer;
  if (fem_gradient_is_path(progress->system->model)) return add_step(answer, progress);
  if (!is_taken(answer, progress)) return STATUS_OK;
  return fem_gradient_find(&answer->gradient, progress->system, &answer->def);
}

Status app_gradient_answer(AppGradientAnswer *answer, const FemModel *model, const AppGradientWords *words,
                           const volatile sig_atomic_t *stop) {
  FemRunResult result = {0};
  FemRunOptions run = {.observe = at_step, .observer = answer, .stop = stop};
  *answer = (AppGradientAnswer){0};
  TRY(prepare(answer, model, words));
  answer->most_megabytes = words->most_megabytes;
  Status status = app_gradient_run(model, &answer->def, &run, &result);
  if (!status && fem_gradient_is_path(model)) {
    int count = answer->steps.count - 1;
    log_info("a replay of %d step%s keeps %.4g MB", count, count == 1 ? "" : "s", megabytes_of(answer));
    status = fem_path_differentiate(&answer->gradient, model, &answer->def, &answer->steps);
  }
  if (!status && !answer->gradient.values)
    status = status_fail(STATUS_SOLVER, "the run ended before a goal was taken: no gradient");
  fem_run_result_destroy(&result);
  return status;
}

void app_gradient_answer_destroy(AppGradientAnswer *answer) {
  fem_gradient_destroy(&answer->gradient);
  fem_replay_steps_destroy(&answer->steps);
  for (int g = 0; g < answer->def.goal_count; g++) app_gradient_destroy_goal(&answer->goals[g]);
}

const char *app_gradient_stiffness(const FemModel *model, const AppGradientWords *words) {
  const FemContactDef *contact = &model->scene->contact;
  if (!contact->is_on) return "none";
  if (contact->stiffness > 0 || contact->law.law.kind != CONTACT_LAW_LINEAR) return "given";
  return words->is_total ? "follows" : "kept";
}
