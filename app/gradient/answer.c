// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/answer.h"

#include <math.h>
#include <stdint.h>

#include "app/gradient/goal.h"
#include "app/gradient/parameter.h"
#include "app/gradient/run.h"
#include "base/log.h"
#include "fem/gradient/path/check.h"

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

static const double MEGABYTE = 1e6;

size_t app_gradient_bytes(double megabytes) {
  double bytes = round(megabytes * MEGABYTE);
  if (!(megabytes > 0)) return 0;
  if (!(bytes >= 1)) return 1;
  return bytes < (double)SIZE_MAX ? (size_t)bytes : SIZE_MAX;
}

// Refuses a replay that cannot keep so little, else says what it keeps.
static Status tell(const AppGradientAnswer *answer) {
  static const double KILOBYTE = 1e3;
  FemReplayPlan plan = fem_replay_steps_plan(&answer->steps);
  int count = answer->steps.count - 1;
  const char *steps = count == 1 ? "step" : "steps";
  double kept = (double)plan.bytes / MEGABYTE, least = ceil((double)plan.least / KILOBYTE) / KILOBYTE;
  if (plan.bytes == 0)
    return status_fail(
        STATUS_INPUT,
        "--memory: a replay of %d %s keeps %.10g MB at least, more than %.10g MB; allow that, take goals "
        "at an earlier time (--at), or longer steps (time.tolerance, output.frames)",
        count, steps, least, (double)answer->steps.most / MEGABYTE);
  if (plan.segment_count > 1)
    log_info("a replay of %d steps keeps %.4g MB, in %d segments of %d steps, all but the last done twice",
             count, kept, plan.segment_count, plan.length);
  else
    log_info("a replay of %d %s keeps %.4g MB", count, steps, kept);
  return STATUS_OK;
}

static Status at_step(void *observer, const FemRunProgress *progress) {
  AppGradientAnswer *answer = observer;
  if (fem_gradient_is_path(progress->system->model))
    return fem_replay_steps_add(&answer->steps, progress->system);
  if (!is_taken(answer, progress)) return STATUS_OK;
  return fem_gradient_find(&answer->gradient, progress->system, &answer->def);
}

Status app_gradient_answer(AppGradientAnswer *answer, const FemModel *model, const AppGradientWords *words,
                           const volatile sig_atomic_t *stop) {
  FemRunResult result = {0};
  FemRunOptions run = {.observe = at_step, .observer = answer, .stop = stop};
  *answer = (AppGradientAnswer){0};
  TRY(prepare(answer, model, words));
  answer->steps.most = app_gradient_bytes(words->most_megabytes);
  Status status = app_gradient_run(model, &answer->def, &run, &result);
  if (!status && fem_gradient_is_path(model)) status = tell(answer);
  if (!status && fem_gradient_is_path(model))
    status = fem_path_differentiate(&answer->gradient, model, &answer->def, &answer->steps, stop);
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
