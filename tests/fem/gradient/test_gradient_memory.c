// SPDX-License-Identifier: GPL-3.0-or-later
// How much memory a replay may keep: gradients are the same, to the bit, with as little as there is a plan
// for.
#include "app/gradient/answer.h"
#include "base/memory.h"
#include "replays.h"

static const char *const scenes[][3] = {{"gradient_motion", "time.end=0.06", "upper"},
                                        {"gradient_slide", "time.end=0.03", "upper"},
                                        {"gradient_damped", "time.end=0.03", "upper"},
                                        {"gradient_rub", "output.frames=70", "lower"}};

// A clock that is read tells how often it was.
double __wrap_clock_cpu_s(void);

double __wrap_clock_cpu_s(void) {
  static int reads;
  return reads++;
}

static Status answer_within(int scene, double megabytes, AppGradientAnswer *answer) {
  char of[2][64];
  snprintf(of[0], sizeof of[0], "displacement:%s:x", scenes[scene][2]);
  snprintf(of[1], sizeof of[1], "position:upper:3:z@%g", scene == 3 ? 0.5 : 0.01);
  const AppGradientWords words = {.of = {of[0], of[1]},
                                  .by = {"bodies.lower.material.young", "contact.stiffness"},
                                  .of_count = 2,
                                  .by_count = 2,
                                  .most_megabytes = megabytes};
  SceneRun run;
  scene_open(&run, scenes[scene][0], (const char *const[]){scenes[scene][1], NULL});
  Status status = app_gradient_answer(answer, &run.model, &words, NULL);
  scene_close(&run);
  return status;
}

static void check_same(const FemGradient *gradient, const FemGradient *other) {
  ck_assert_mem_eq(gradient->values, other->values, 2 * sizeof(double));
  ck_assert_mem_eq(gradient->derivatives, other->derivatives, 4 * sizeof(double));
  ck_assert_mem_eq(gradient->residuals, other->residuals, 2 * sizeof(double));
  ck_assert(gradient->unbalanced == other->unbalanced && gradient->switches == other->switches);
  for (int i = 0; i < 4; i++) ck_assert_double_ne(gradient->derivatives[i], 0);
}

START_TEST(gradients_are_the_same_with_as_little_memory_as_there_is_a_plan_for) {
  AppGradientAnswer all, some;
  ck_assert_ok(answer_within(_i, 0, &all));
  all.steps.most = all.steps.bytes - 1;
  FemReplayPlan plan = fem_replay_steps_plan(&all.steps);
  const size_t mosts[] = {plan.bytes, plan.least};
  ck_assert_double_eq(all.gradient.replay_s, 1);
  ck_assert_uint_lt(plan.least, all.steps.bytes);
  for (int k = 0; k < 2; k++) {
    ck_assert_ok(answer_within(_i, 1e-6 * (double)mosts[k], &some));
    plan = fem_replay_steps_plan(&some.steps);
    ck_assert_int_ge(plan.segment_count, 2);
    ck_assert_uint_le(plan.bytes, mosts[k]);
    check_same(&all.gradient, &some.gradient);
    ck_assert_double_eq(some.gradient.replay_s, 2 * plan.segment_count - 1); // all but one twice
    app_gradient_answer_destroy(&some);
  }
  app_gradient_answer_destroy(&all);
}
END_TEST

START_TEST(with_less_it_is_refused_and_says_how_much_is_needed) {
  AppGradientAnswer answer;
  ck_assert_int_eq(answer_within(_i, 1e-7, &answer), STATUS_INPUT); // no byte, which is not all there is
  const char *told = strstr(status_message(), "keeps ");
  ck_assert_msg(told && strstr(told, "MB at least"), "%s", status_message());
  const double least = strtod(told + strlen("keeps "), NULL);
  size_t exact = fem_replay_steps_plan(&answer.steps).least;
  app_gradient_answer_destroy(&answer);
  ck_assert_int_eq(answer_within(_i, 1e-6 * (double)(exact - 1), &answer), STATUS_INPUT);
  app_gradient_answer_destroy(&answer);
  ck_assert_near(least, 1e-6 * (double)exact, 1e-3);
  ck_assert_ok(answer_within(_i, least, &answer)); // as it is told, rounded up
  app_gradient_answer_destroy(&answer);
}
END_TEST

START_TEST(megabytes_are_the_nearest_bytes) {
  ck_assert_uint_eq(app_gradient_bytes(0), 0);
  ck_assert_uint_eq(app_gradient_bytes(1.001), 1001000); // 1.001 * 1e6 is less
  ck_assert_uint_eq(app_gradient_bytes(1e-7), 1);
  ck_assert_uint_eq(app_gradient_bytes(1.9e13), SIZE_MAX);
  ck_assert_uint_eq(app_gradient_bytes(INFINITY), SIZE_MAX);
}
END_TEST

// Of all that grows with the number of steps.
static size_t held_by(const FemReplay *replay) {
  const FemReplaySteps *steps = replay->steps;
  size_t headers = memory_held(replay->histories) / sizeof *replay->histories;
  const void *const arrays[] = {replay->u,         replay->v,    replay->saved,
                                replay->histories, steps->times, steps->u};
  size_t bytes = memory_held_by(sizeof arrays / sizeof *arrays, arrays);
  for (size_t i = 0; i < headers; i++) bytes += memory_held(replay->histories[i].values);
  for (int k = 0; steps->u && k < steps->count; k++) bytes += memory_held(steps->u[k]);
  return bytes;
}

static void check_plan(const Asked *asked, const FemReplaySteps *steps) {
  static const double ROUNDED = 1.02, LEAST = 0.9; // by allocators; all steps are reckoned as the largest
  FemReplay replay;
  SceneRun run;
  double most = 0;
  scene_open(&run, asked->scene, (const char *const[]){asked->setting, NULL});
  ck_assert_ok(fem_replay_create(&replay, &run.model, steps));
  ck_assert_ok(fem_replay_go(&replay));
  for (int k = steps->count - 1; k >= 0; k--) {
    ck_assert_ok(fem_replay_return(&replay, k));
    most = fmax(most, (double)held_by(&replay));
  }
  double plan = (double)replay.plan.bytes;
  ck_assert_double_le(most, ROUNDED * plan);
  ck_assert_double_ge(most, LEAST * plan);
  fem_replay_destroy(&replay);
  scene_close(&run);
}

START_TEST(a_replay_keeps_what_its_plan_says) {
  const Asked asked = {.scene = scenes[_i][0], .setting = scenes[_i][1], .of = {"energy:elastic"}};
  FemReplaySteps steps;
  find_steps(&asked, &steps);
  check_plan(&asked, &steps);
  steps.most = steps.bytes - 1;
  steps.most = fem_replay_steps_plan(&steps).bytes;
  ck_assert_int_ge(fem_replay_steps_plan(&steps).segment_count, 2);
  check_plan(&asked, &steps);
  steps.most = fem_replay_steps_plan(&steps).least;
  check_plan(&asked, &steps);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// Of eight steps and the start, of three numbers a coordinate, and what friction remembers: less than a
// block.
START_TEST(a_short_replay_keeps_all_its_steps) {
  const Asked asked = {.scene = "gradient_rub", .setting = "time.end=1", .of = {"energy:elastic"}};
  FemReplaySteps steps;
  find_steps(&asked, &steps);
  size_t positions = 3 * sizeof(double) * (size_t)steps.count * (size_t)steps.unknown_count;
  ck_assert_uint_gt(steps.bytes, positions);
  ck_assert_uint_lt(steps.bytes, 2 * positions);
  steps.most = steps.bytes - 1;
  FemReplayPlan plan = fem_replay_steps_plan(&steps);
  ck_assert_uint_eq(plan.bytes, 0);
  ck_assert_uint_eq(plan.least, steps.bytes);
  fem_replay_steps_destroy(&steps);
}
END_TEST

int main(void) {
  enum { SCENE_COUNT = sizeof scenes / sizeof *scenes };
  TCase *test_case = tcase_create("gradient_memory");
  tcase_add_loop_test(test_case, gradients_are_the_same_with_as_little_memory_as_there_is_a_plan_for, 0,
                      SCENE_COUNT);
  tcase_add_loop_test(test_case, with_less_it_is_refused_and_says_how_much_is_needed, 0, SCENE_COUNT);
  tcase_add_loop_test(test_case, a_replay_keeps_what_its_plan_says, 0, SCENE_COUNT);
  tcase_add_test(test_case, megabytes_are_the_nearest_bytes);
  tcase_add_test(test_case, a_short_replay_keeps_all_its_steps);
  return suite_run("gradient_memory", test_case, 120);
}
