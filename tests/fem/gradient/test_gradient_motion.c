// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of motions against central differences of replays with the same steps, and what has none.
#include "fem/gradient/motion.h"

#include "app/gradient/goal.h"
#include "app/gradient/parameter.h"
#include "static_solve.h"

enum { MOST = 16 };

typedef struct Asked {
  const char *scene, *setting;
  const char *of[MOST], *by[MOST]; // ended by NULL
  double tolerance;                // relative to g/p
} Asked;

typedef struct Answer {
  int goal_count, parameter_count;
  FemGoal goals[MOST];
  FemParameter parameters[MOST];
  double values[MOST]; // of the parameters
  FemGradient gradient;
} Answer;

static void destroy(Answer *answer) {
  fem_gradient_destroy(&answer->gradient);
  for (int g = 0; g < answer->goal_count; g++) app_gradient_destroy_goal(&answer->goals[g]);
}

static Status record(void *observer, const FemRunProgress *progress) {
  FemMotionSteps *steps = observer;
  bool is_new = progress->time > steps->times[steps->count - 1];
  return is_new ? fem_motion_steps_add(steps, progress->time) : STATUS_OK;
}

// The steps of the scene as it is.
static void find_steps(const Asked *asked, FemMotionSteps *steps) {
  SceneRun scene;
  *steps = (FemMotionSteps){0};
  ck_assert_ok(fem_motion_steps_add(steps, 0));
  scene_open(&scene, asked->scene, (const char *const[]){asked->setting, NULL});
  FemRunOptions options = {.observe = record, .observer = steps};
  ck_assert_ok(fem_run(&scene.model, &options, &scene.result));
  scene_close(&scene);
}

static void replay(const Asked *asked, const FemMotionSteps *steps, const char *override,
                   bool with_parameters, Answer *answer) {
  SceneRun scene;
  *answer = (Answer){0};
  scene_open(&scene, asked->scene, (const char *const[]){asked->setting, override, NULL});
  for (const char *const *of = asked->of; *of; of++)
    ck_assert_ok(app_gradient_read_goal(&scene.model, *of, &answer->goals[answer->goal_count++]));
  for (const char *const *by = asked->by; *by && with_parameters; by++) {
    FemParameter *parameter = &answer->parameters[answer->parameter_count];
    ck_assert_ok(app_gradient_read_parameter(&scene.model, *by, parameter));
    answer->values[answer->parameter_count++] = fem_parameter_value(&scene.model, parameter);
  }
  const FemGradientDef def = {answer->goals, answer->parameters, answer->goal_count, answer->parameter_count,
                              false};
  ck_assert_ok(fem_motion_check(&scene.model, &def));
  ck_assert_ok(fem_motion_differentiate(&answer->gradient, &scene.model, &def, steps));
  scene_close(&scene);
}

// p ∂g/∂p of every goal by differences of the fourth order.
static void differ(const Asked *asked, const FemMotionSteps *steps, const char *key, double middle,
                   double size, double shares[MOST]) {
  static const double STEP = 1e-4, places[] = {-2, -1, 1, 2};
  static const double weights[] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};
  memset(shares, 0, MOST * sizeof *shares);
  for (int k = 0; k < 4; k++) {
    char override[256];
    Answer answer;
    snprintf(override, sizeof override, "%s=%.17g", key, middle + places[k] * STEP * size);
    replay(asked, steps, override, false, &answer);
    for (int g = 0; g < answer.goal_count; g++) shares[g] += weights[k] / STEP * answer.gradient.values[g];
    destroy(&answer);
  }
}

// Relative to g/p.
static void check_against_replays(const Asked *asked) {
  static const double OF_ZERO = 1e-2;
  FemMotionSteps steps;
  Answer answer;
  find_steps(asked, &steps);
  ck_assert_int_gt(steps.count, 20);
  replay(asked, &steps, NULL, true, &answer);
  ck_assert_double_le(answer.gradient.unbalanced, 1e-9);
  for (int p = 0; p < answer.parameter_count; p++) {
    double shares[MOST], size = answer.values[p] != 0 ? fabs(answer.values[p]) : OF_ZERO;
    differ(asked, &steps, asked->by[p], answer.values[p], size, shares);
    for (int g = 0; g < answer.goal_count; g++) {
      double whole = fabs(answer.gradient.values[g]);
      double found = answer.gradient.derivatives[g * answer.parameter_count + p] * size;
      ck_assert_double_le(answer.gradient.residuals[g], 1e-9);
      ck_assert_double_gt(fabs(found), 0); // of bodies that never met, it were 0 by contact.stiffness
      ck_assert_msg(fabs(found - shares[g]) <= asked->tolerance * whole,
                    "%s by %s: p dg/dp = %.12g, replays %.12g, g = %.6g", asked->of[g], asked->by[p], found,
                    shares[g], answer.gradient.values[g]);
    }
  }
  destroy(&answer);
  fem_motion_steps_destroy(&steps);
}

START_TEST(a_block_thrown_upon_a_shaken_one_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.06",
      .tolerance = 1e-6,
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:z", "energy"},
      .by = {"bodies.lower.material.young", "bodies.upper.material.density", "bodies.upper.velocity[2]",
             "bodies.lower.driven[0].amplitude[2]", "contact.stiffness", "bodies.upper.loads[0].force[0]"}};
  check_against_replays(&asked);
}
END_TEST

// Pairs of cells that begin to overlap within a difference make kinks in the force.
START_TEST(a_motion_that_ends_in_contact_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.012",
      .tolerance = 1e-5,
      .of = {"force:upper:lower:z", "displacement:upper:z", "energy"},
      .by = {"bodies.lower.material.young", "bodies.upper.velocity[2]", "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

static void refuse(const char *override, const char *by, const char *why) {
  SceneRun scene;
  FemParameter parameter;
  FemMotionSteps steps = {0};
  FemGradient gradient;
  scene_open(&scene, "gradient_motion", (const char *const[]){override, NULL});
  Status status = app_gradient_read_parameter(&scene.model, by, &parameter);
  ck_assert_ok(status);
  status = fem_motion_differentiate(&gradient, &scene.model, &(FemGradientDef){NULL, &parameter, 0, 1, false},
                                    &steps);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s: %s", override, status_message());
  fem_gradient_destroy(&gradient);
  scene_close(&scene);
}

START_TEST(motions_without_a_gradient_are_refused_by_name) {
  const char *young = "bodies.upper.material.young";
  refuse("effects.damping=1e-3", young, "body 'lower' is damped");
  refuse("bodies.upper.material.viscosity=10", young, "body 'upper' is damped");
  refuse("contact.viscosity=1", young, "contact.viscosity");
  refuse("contact.rest={speed: 1e-3}", young, "contact.rest");
  refuse("contact.friction=0.1", young, "friction");
  refuse("bodies.lower.driven[0].release=0.01", young, "released");
  refuse("time.end=0.06", "bodies.upper.place.translate[0]", "static scenes alone");
  refuse("time.end=0.06", "bodies.upper.material.damping", "no derivative by damping");
  refuse("time.end=0.06", young, "made no step");
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_motion");
  tcase_add_test(test_case, a_block_thrown_upon_a_shaken_one_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_motion_that_ends_in_contact_agrees_with_differences_of_replays);
  tcase_add_test(test_case, motions_without_a_gradient_are_refused_by_name);
  return suite_run("gradient_motion", test_case, 300);
}
