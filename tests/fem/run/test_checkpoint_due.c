// SPDX-License-Identifier: GPL-3.0-or-later
// When a checkpoint is due, at the edges: after enough steps, early in a run, and only where the run is calm.
#include "suite.h"

#include "fem/run/checkpoint/run_checkpoint.h"

// A run to 1 s, and what it is made of as far as checkpoints ask for it.
typedef struct Course {
  FemSceneDef scene;
  FemModel model;
  FemRunState run;
  FemIntegratorStats stats;
} Course;

static void start(Course *course, int unknowns, double last, double time, long long steps) {
  *course = (Course){.scene = {.end = 1, .frames = 10, .checkpoint_frames = -1}};
  course->model = (FemModel){.scene = &course->scene, .free_count = unknowns};
  course->stats.steps = steps;
  course->run = (FemRunState){.model = &course->model,

                              .time = time,
                              .stage_end = 1,
                              .checkpoint.time = last};
}

// With a next step of so many times the mean of all.
static bool is_due(Course *course, double share) {
  course->stats.current_step = share * course->run.time / (double)course->stats.steps;
  return fem_run_checkpoint_is_due(&course->run, &course->stats);
}

START_TEST(a_checkpoint_waits_for_a_step_that_is_no_shorter_than_the_mean) {
  Course course;
  start(&course, 1, 0.4, 0.5, fem_run_checkpoint_steps(1));
  ck_assert(is_due(&course, 1 + 1e-12));
  ck_assert(!is_due(&course, 1 - 1e-12));
}
END_TEST

START_TEST(it_waits_no_longer_than_for_as_many_steps_again) {
  Course course;
  long long enough = fem_run_checkpoint_steps(1);
  start(&course, 1, 0.4, 0.5, 2 * enough - 1);
  ck_assert(!is_due(&course, 0.1));
  start(&course, 1, 0.4, 0.5, 2 * enough);
  ck_assert(is_due(&course, 0.1));
}
END_TEST

START_TEST(enough_are_a_million_steps_times_unknowns_and_two_hundred_at_least) {
  Course course;
  for (int k = 0; k < 2; k++) {
    int unknowns = k == 0 ? 1000 : 1000000, enough = k == 0 ? 1000 : 200;
    start(&course, unknowns, 0.4, 0.5, enough - 1);
    ck_assert(!is_due(&course, 2));
    start(&course, unknowns, 0.4, 0.5, enough);
    ck_assert(is_due(&course, 2));
  }
}
END_TEST

// The first at 2 % of the time, others at four times the time of the one before, and none in fewer than
// twenty steps or in the last half.
START_TEST(early_in_a_run_they_come_sooner) {
  Course course;
  const struct {
    double last, time;
    long long steps;
    bool is_due;
  } rows[] = {{0, 0.02, 20, true},    {0, 0.0199, 20, false},    {0, 0.02, 19, false},
              {0.03, 0.12, 20, true}, {0.03, 0.1199, 20, false}, {0.03, 0.12, 19, false},
              {0.1, 0.5, 20, true},   {0.1, 0.5001, 20, false}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    start(&course, 1000, rows[k].last, rows[k].time, rows[k].steps);
    ck_assert_msg(is_due(&course, 2) == rows[k].is_due, "row %zu", k);
    ck_assert(!is_due(&course, 0.9)); // not even early where the run is not calm
  }
}
END_TEST

START_TEST(none_is_due_at_the_end_of_a_stage_or_of_the_run) {
  Course course;
  start(&course, 1, 0.4, 0.5, 2 * fem_run_checkpoint_steps(1));
  course.run.stage_end = 0.5;
  ck_assert(!is_due(&course, 2));
  start(&course, 1, 0.4, 1, 2 * fem_run_checkpoint_steps(1));
  ck_assert(!is_due(&course, 2));
}
END_TEST

START_TEST(a_static_scene_has_one_after_four_steps) {
  Course course;
  for (int steps = 3; steps <= 4; steps++) {
    start(&course, 1, 0.4, 0.5, steps);
    course.scene.is_static = true;
    ck_assert(is_due(&course, 0.1) == (steps == 4));
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("checkpoint_due");
  tcase_add_test(cases, a_checkpoint_waits_for_a_step_that_is_no_shorter_than_the_mean);
  tcase_add_test(cases, it_waits_no_longer_than_for_as_many_steps_again);
  tcase_add_test(cases, enough_are_a_million_steps_times_unknowns_and_two_hundred_at_least);
  tcase_add_test(cases, early_in_a_run_they_come_sooner);
  tcase_add_test(cases, none_is_due_at_the_end_of_a_stage_or_of_the_run);
  tcase_add_test(cases, a_static_scene_has_one_after_four_steps);
  return suite_run("checkpoint_due", cases, 20);
}
