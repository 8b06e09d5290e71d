// SPDX-License-Identifier: GPL-3.0-or-later
// A wish to end is heard in the replay of a run, on the way there and on the way back.
#include "app/gradient/answer.h"
#include "replays.h"

// The step after whose return it is wished; −1: before the replay. And how many steps were gone back over.
static int wished_at, returned;
static volatile sig_atomic_t stop;

Status __real_fem_replay_go(FemReplay *replay);
Status __wrap_fem_replay_go(FemReplay *replay);
Status __real_fem_replay_return(FemReplay *replay, int k);
Status __wrap_fem_replay_return(FemReplay *replay, int k);

Status __wrap_fem_replay_go(FemReplay *replay) {
  stop = wished_at < 0;
  return __real_fem_replay_go(replay);
}

Status __wrap_fem_replay_return(FemReplay *replay, int k) {
  Status status = __real_fem_replay_return(replay, k);
  if (k == wished_at) stop = 1;
  returned++;
  return status;
}

static const char *const scenes[][2] = {{"gradient_motion", "time.end=0.02"}, {"gradient_rub", "time.end=1"}};

static void interrupt(int scene, int wished, int *count) {
  const AppGradientWords words = {
      .of = {"energy:elastic"}, .by = {"contact.stiffness"}, .of_count = 1, .by_count = 1};
  AppGradientAnswer answer;
  SceneRun run;
  stop = 0, wished_at = wished, returned = 0;
  scene_open(&run, scenes[scene][0], (const char *const[]){scenes[scene][1], NULL});
  ck_assert_int_eq(app_gradient_answer(&answer, &run.model, &words, &stop), STATUS_INTERRUPTED);
  ck_assert_msg(strstr(status_message(), "of the replay: no gradient"), "%s", status_message());
  *count = answer.steps.count;
  app_gradient_answer_destroy(&answer);
  scene_close(&run);
}

START_TEST(a_replay_ends_before_its_first_step_is_through) {
  int count;
  interrupt(_i, -1, &count);
  ck_assert_int_gt(count, 2);
  ck_assert_int_eq(returned, 0);
}
END_TEST

START_TEST(the_way_back_ends_at_that_step) {
  enum { STEP = 3 };
  int count;
  interrupt(_i, STEP, &count);
  ck_assert_int_eq(returned, count - STEP);
}
END_TEST

int main(void) {
  enum { SCENE_COUNT = sizeof scenes / sizeof *scenes };
  TCase *test_case = tcase_create("gradient_stop");
  tcase_add_loop_test(test_case, a_replay_ends_before_its_first_step_is_through, 0, SCENE_COUNT);
  tcase_add_loop_test(test_case, the_way_back_ends_at_that_step, 0, SCENE_COUNT);
  return suite_run("gradient_stop", test_case, 60);
}
