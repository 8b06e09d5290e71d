// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/limits.h"

enum { TEXT_SIZE = 256, SEED = 35 };
// Shares of a parameter by which it differs between two runs. A motion chooses its steps anew, which
// changes g by up to time.tolerance, so it takes a longer way.
static const double OF_STATIC = 1e-4, OF_MOTION = 1e-2;
// The error of a step of second order falls by this where it is halved.
static const double OF_HALF = 8;

// The scene with other values.
typedef struct Other {
  AppJobOptions job;
  char texts[APP_GRADIENT_MOST][TEXT_SIZE];
} Other;

static Status add(Other *other, const char *key, double value) {
  int place = other->job.override_count;
  char *text = other->texts[place % APP_GRADIENT_MOST];
  if (place >= APP_MAX_OVERRIDES)
    return status_fail(STATUS_INPUT, "--check changes parameters by --set, of which there are at most %d",
                       APP_MAX_OVERRIDES);
  if (snprintf(text, TEXT_SIZE, "%s=%.17g", key, value) >= TEXT_SIZE)
    return status_fail(STATUS_INPUT, "--check takes keys of fewer than %d characters, not %s", TEXT_SIZE - 25,
                       key);
  other->job.overrides[other->job.override_count++] = text;
  return STATUS_OK;
}

static Status answer_other(const Other *other, const AppGradientWords *words, AppGradientAnswer *answer) {
  AppJob job;
  *answer = (AppGradientAnswer){0};
  TRY(app_job_open(&job, &other->job, NULL, NULL));
  Status status = app_gradient_answer(answer, &job.model, words, app_job_stop_flag());
  app_job_close(&job);
  return status;
}

// ---- Half the steps.

static Status halve(AppGradientCheck *check, Other *other, const FemModel *model,
                    const AppGradientWords *words, const AppGradientAnswer *answer) {
  const FemSceneDef *scene = model->scene;
  AppGradientAnswer half;
  AppGradientWords keys = *words;
  keys.by_weights = false;
  keys.most_megabytes = 2 * words->most_megabytes; // as many steps, twice
  TRY(scene->is_static ? add(other, "output.frames", 2 * scene->frames)
                       : add(other, "time.tolerance", scene->tolerance / OF_HALF));
  if (!scene->is_static && scene->max_step > 0) TRY(add(other, "time.max_step", scene->max_step / 2));
  Status status = status_prefix(answer_other(other, &keys, &half), "--check, with half the steps");
  for (int g = 0; g < words->of_count && !status; g++)
    for (int p = 0; p < words->by_count; p++) {
      int place = g * words->by_count + p;
      double own = answer->gradient.derivatives[place], now = half.gradient.derivatives[place];
      check->halved[g][p] = fabs(now - own) / fabs(own);
    }
  app_gradient_answer_destroy(&half);
  return status;
}

// ---- Along a direction.

typedef struct Direction {
  double step;                    // that is taken along it
  double ways[APP_GRADIENT_MOST]; // of each parameter, in its unit
} Direction;

// Whether what can meet does so with another stiffness or level of smoothness.
static bool differs(const FemModel *model, const FemCompliance *one, const FemCompliance *other) {
  for (int a = 0; a < model->body_count; a++) {
    if (one->levels[a] != other->levels[a]) return true;
    for (int b = 0; b < one->party_count; b++) {
      double own = one->stiffness[a * one->party_count + b], now = other->stiffness[a * one->party_count + b];
      if (fem_compliance_meets(model, a, b) && !(fabs(now - own) <= FEM_ROUNDING * own)) return true;
    }
  }
  return false;
}

static Status compare_choices(const FemModel *model, const FemModel *changed, bool *has_changed) {
  FemCompliance own, now;
  TRY(fem_compliance_choose(model, &own));
  Status status = fem_compliance_choose(changed, &now);
  if (!status) {
    *has_changed = differs(model, &own, &now);
    fem_compliance_destroy(&now);
  }
  fem_compliance_destroy(&own);
  return status;
}

// Whether a contact stiffness that is chosen is another one with this value.
static Status try_choice(const AppJobOptions *options, const FemModel *model, const char *key, double value,
                         bool *has_changed) {
  Other other = {.job = *options};
  AppJob job;
  TRY(add(&other, key, value));
  TRY(app_job_open(&job, &other.job, NULL, NULL));
  Status status = compare_choices(model, &job.model, has_changed);
  app_job_close(&job);
  return status;
}

// Whether derivatives keep a contact stiffness that a parameter may change.
static bool keeps_choice(const FemParameter *parameter, const char *stiffness) {
  bool follows = parameter->kind == FEM_PARAMETER_YOUNG || parameter->kind == FEM_PARAMETER_POISSON;
  return strcmp(stiffness, "kept") == 0 || (strcmp(stiffness, "follows") == 0 && !follows);
}

// Parameters by which another run would differ in more than their derivatives do stay.
static Status draw_direction(Direction *direction, const AppJobOptions *options, const FemModel *model,
                             const AppGradientWords *words, const AppGradientAnswer *answer) {
  *direction = (Direction){.step = model->scene->is_static ? OF_STATIC : OF_MOTION};
  Random random = random_seeded(SEED, 0);
  const char *stiffness = app_gradient_stiffness(model, words);
  for (int p = 0; p < words->by_count; p++) {
    const FemParameter *parameter = &answer->parameters[p];
    double value = fem_parameter_value(model, parameter), way = random_between(&random, -1, 1) * value;
    bool stays = way == 0 || parameter->kind == FEM_PARAMETER_REST || answer->gradient.kinks[p];
    if (!stays && keeps_choice(parameter, stiffness))
      TRY(try_choice(options, model, words->by[p], value + direction->step * way, &stays));
    if (!stays) direction->ways[p] = way;
  }
  return STATUS_OK;
}

static bool leads_away(const Direction *direction, const AppGradientWords *words) {
  for (int p = 0; p < words->by_count; p++)
    if (direction->ways[p] != 0) return true;
  return false;
}

static Status add_along(AppGradientCheck *check, Other *other, const Direction *direction, double side,
                        const FemModel *model, const AppGradientWords *words,
                        const AppGradientAnswer *answer) {
  AppGradientWords values = *words;
  AppGradientAnswer there;
  for (int p = 0; p < words->by_count; p++) {
    double value = fem_parameter_value(model, &answer->parameters[p]);
    if (direction->ways[p] != 0)
      TRY(add(other, words->by[p], value + side * direction->step * direction->ways[p]));
  }
  values.by_count = 0;
  values.by_weights = false;
  Status status = status_prefix(answer_other(other, &values, &there), "--check, along a direction");
  for (int g = 0; g < words->of_count && !status; g++)
    check->between[g] += side * there.gradient.values[g] / (2 * direction->step);
  app_gradient_answer_destroy(&there);
  return status;
}

Status app_gradient_check(AppGradientCheck *check, const AppJobOptions *job, const FemModel *model,
                          const AppGradientWords *words, const AppGradientAnswer *answer) {
  Other half = {.job = *job}, ahead = {.job = *job}, behind = {.job = *job};
  Direction direction;
  *check = (AppGradientCheck){0};
  TRY(draw_direction(&direction, job, model, words, answer));
  TRY(halve(check, &half, model, words, answer));
  if (!leads_away(&direction, words)) {
    for (int g = 0; g < words->of_count; g++) check->along[g] = check->between[g] = NAN;
    return STATUS_OK;
  }
  for (int g = 0; g < words->of_count; g++)
    for (int p = 0; p < words->by_count; p++)
      if (direction.ways[p] != 0)
        check->along[g] += answer->gradient.derivatives[g * words->by_count + p] * direction.ways[p];
  TRY(add_along(check, &ahead, &direction, 1, model, words, answer));
  return add_along(check, &behind, &direction, -1, model, words, answer);
}
