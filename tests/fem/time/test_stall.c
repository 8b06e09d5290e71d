// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/stall.h"

#include "suite.h"

static const double LONG_STEP = 1; // no bound

// So many steps of `step` seconds, of which every `vain_every`th (0: none) is tried twice; until the verdict
// is another than to go on. `*time` goes on.
static FemStallVerdict march(FemStall *stall, int count, double step, int vain_every, double *time,
                             int *taken) {
  FemStallVerdict verdict = FEM_STALL_GOES_ON;
  for (*taken = 0; *taken < count && verdict == FEM_STALL_GOES_ON; ++*taken) {
    int vain = vain_every > 0 && *taken % vain_every == 0;
    verdict = fem_stall_add(stall, 1 + vain, vain, *time += step, LONG_STEP);
  }
  return verdict;
}

START_TEST(a_steady_run_goes_on_however_many_steps_it_takes_and_loses) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  double time = 0;
  int taken;
  ck_assert_int_eq(march(&stall, 300000, 1.0 / 300000, 1, &time, &taken), FEM_STALL_GOES_ON);
  ck_assert_int_eq(taken, 300000);
  ck_assert(stall.fastest > 0); // it was judged
}
END_TEST

START_TEST(a_run_that_would_take_a_million_steps_is_given_up_after_one_window) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  double time = 0;
  int taken;
  ck_assert_int_eq(march(&stall, 10000, 0.9e-6, 0, &time, &taken), FEM_STALL_STANDS);
  ck_assert_int_eq(taken, FEM_STALL_WINDOW);
  ck_assert_near(stall.left, (1 - time) / 0.9e-6, 1);
}
END_TEST

// Just more, and just fewer, than a million tries for the whole run; or than a tenth of what the longest
// steps could have made.
START_TEST(at_the_edges_a_run_just_goes_on) {
  static const double LESS = 1 - 1e-6, MORE = 1 + 1e-6;
  const double window = FEM_STALL_WINDOW;
  for (int is_more = 0; is_more < 2; is_more++) {
    FemStallVerdict verdict = is_more ? FEM_STALL_GOES_ON : FEM_STALL_STANDS;
    FemStall stall = fem_stall_begin(0, 1, 0.1);
    ck_assert_int_eq(fem_stall_add(&stall, FEM_STALL_WINDOW, 0, (is_more ? MORE : LESS) * window / 1e6, 1),
                     verdict);
    stall = fem_stall_begin(0, 1, 0.1);
    double reached = (is_more ? MORE : LESS) * 0.1 * window * 1e-7;
    ck_assert_int_eq(fem_stall_add(&stall, FEM_STALL_WINDOW, 0, reached, 1e-7), verdict);
  }
}
END_TEST

START_TEST(a_run_that_makes_no_way_at_all_is_given_up) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  FemStallVerdict verdict = FEM_STALL_GOES_ON;
  int count = 0;
  for (; count < 2 * FEM_STALL_WINDOW && verdict == FEM_STALL_GOES_ON; count++) {
    verdict = fem_stall_add(&stall, 1, 0, 1e-3, LONG_STEP);
    fem_stall_take_back(&stall);
  }
  // the first window came from 0 to 1e-3
  ck_assert_int_eq(verdict, FEM_STALL_STANDS);
  ck_assert_int_eq(count, FEM_STALL_WINDOW);
}
END_TEST

START_TEST(steps_as_long_as_allowed_are_no_stall) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  for (int k = 1; k <= 10000; k++)
    ck_assert_int_eq(fem_stall_add(&stall, 1, 0, k * 1e-8, 1e-8), FEM_STALL_GOES_ON);
}
END_TEST

START_TEST(the_end_is_no_stall) {
  FemStall stall = fem_stall_begin(1 - 1e-9, 1, 0.1);
  for (int k = 1; k < FEM_STALL_WINDOW; k++)
    ck_assert_int_eq(fem_stall_add(&stall, 1, 0, 1 - 1e-9, LONG_STEP), FEM_STALL_GOES_ON);
  ck_assert_int_eq(fem_stall_add(&stall, 1, 0, 1, LONG_STEP), FEM_STALL_GOES_ON);
}
END_TEST

// Freely at first, then in contact: fast, with every `vain_every`th step tried twice, at `slow` a step.
static FemStallVerdict meet(double frame, double fast, double slow, int vain_every, int *taken) {
  FemStall stall = fem_stall_begin(0, 1, frame);
  double time = 0;
  ck_assert_int_eq(march(&stall, FEM_STALL_WINDOW, fast, 0, &time, taken), FEM_STALL_GOES_ON);
  return march(&stall, 20000, slow, vain_every, &time, taken);
}

START_TEST(a_run_creeps_that_slows_down_and_loses_steps_and_has_far_to_go) {
  int taken;
  ck_assert_int_eq(meet(0.1, 1e-4, 4e-6, 2, &taken), FEM_STALL_CREEPS);
  ck_assert_int_le(taken, 2 * FEM_STALL_WINDOW); // two windows of tries
  ck_assert_int_gt(taken, FEM_STALL_WINDOW);
}
END_TEST

START_TEST(with_one_of_the_four_missing_it_is_no_creep) {
  int taken;
  ck_assert_int_eq(meet(0.1, 1e-4, 4e-6, 4, &taken), FEM_STALL_GOES_ON); // a fifth in vain
  ck_assert_int_eq(meet(0.1, 2e-5, 4e-6, 2, &taken), FEM_STALL_GOES_ON); // slower by seven, with what is lost
  ck_assert_int_eq(meet(0.1, 2e-4, 1.5e-5, 2, &taken), FEM_STALL_GOES_ON); // 60,000 left
  ck_assert_int_eq(meet(1e-3, 1e-4, 4e-6, 2, &taken), FEM_STALL_GOES_ON);  // frame after frame
}
END_TEST

// A window at a fast pace, then two of which each comes `slow` seconds far.
static FemStallVerdict creep(double frame, double fast, double slow, long long vain) {
  FemStall stall = fem_stall_begin(0, 1, frame);
  ck_assert_int_eq(fem_stall_add(&stall, FEM_STALL_WINDOW, 0, fast, LONG_STEP), FEM_STALL_GOES_ON);
  ck_assert_int_eq(fem_stall_add(&stall, FEM_STALL_WINDOW, vain, fast + slow, LONG_STEP), FEM_STALL_GOES_ON);
  return fem_stall_add(&stall, FEM_STALL_WINDOW, vain, fast + 2 * slow, LONG_STEP);
}

// Just more, and just not more, than a quarter in vain, a hundred thousand tries left, ten times slower, and
// from one frame to the next.
START_TEST(at_the_edges_a_run_just_creeps_and_just_does_not) {
  static const double LESS = 1 - 1e-9, MORE = 1 + 1e-9;
  const long long quarter = FEM_STALL_WINDOW / 4;
  ck_assert_int_eq(creep(0.1, 0.2, 0.01, quarter + 1), FEM_STALL_CREEPS);
  ck_assert_int_eq(creep(0.1, 0.2, 0.01, quarter), FEM_STALL_GOES_ON);
  double far = 0.8 * FEM_STALL_WINDOW / (1e5 + 2 * FEM_STALL_WINDOW); // leaves 1e5 tries after both windows
  ck_assert_int_eq(creep(0.1, 0.2, LESS * far, quarter + 1), FEM_STALL_CREEPS);
  ck_assert_int_eq(creep(0.1, 0.2, MORE * far, quarter + 1), FEM_STALL_GOES_ON);
  ck_assert_int_eq(creep(0.1, 0.1, LESS * 0.01, quarter + 1), FEM_STALL_CREEPS);
  ck_assert_int_eq(creep(0.1, 0.1, MORE * 0.01, quarter + 1), FEM_STALL_GOES_ON);
  ck_assert_int_eq(creep(0.01, 0.2, LESS * 0.01, quarter + 1), FEM_STALL_CREEPS);
  ck_assert_int_eq(creep(0.01, 0.2, MORE * 0.01, quarter + 1), FEM_STALL_GOES_ON);
}
END_TEST

// A tenth of the run asleep, then at the pace of before.
START_TEST(sleep_is_no_pace_to_be_held) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  double time = 0;
  int taken;
  ck_assert_int_eq(march(&stall, 1000, 4e-6, 2, &time, &taken), FEM_STALL_GOES_ON);
  fem_stall_pass(&stall, 0.1);
  time += 0.1;
  ck_assert_int_eq(march(&stall, 20000, 4e-6, 2, &time, &taken), FEM_STALL_GOES_ON);
  ck_assert_near(stall.fastest, 4e-6 / 1.5, 1e-8);
}
END_TEST

START_TEST(one_window_of_creeping_is_forgiven) {
  FemStall stall = fem_stall_begin(0, 1, 0.1);
  double time = 0;
  int taken;
  for (int k = 0; k < 5; k++) {
    ck_assert_int_eq(march(&stall, FEM_STALL_WINDOW, 3e-5, 0, &time, &taken), FEM_STALL_GOES_ON);
    ck_assert_int_eq(march(&stall, 1334, 2e-6, 2, &time, &taken), FEM_STALL_GOES_ON);
    ck_assert_int_eq(stall.strikes, 1);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("stall");
  tcase_add_test(cases, a_steady_run_goes_on_however_many_steps_it_takes_and_loses);
  tcase_add_test(cases, a_run_that_would_take_a_million_steps_is_given_up_after_one_window);
  tcase_add_test(cases, at_the_edges_a_run_just_goes_on);
  tcase_add_test(cases, a_run_that_makes_no_way_at_all_is_given_up);
  tcase_add_test(cases, steps_as_long_as_allowed_are_no_stall);
  tcase_add_test(cases, the_end_is_no_stall);
  tcase_add_test(cases, a_run_creeps_that_slows_down_and_loses_steps_and_has_far_to_go);
  tcase_add_test(cases, with_one_of_the_four_missing_it_is_no_creep);
  tcase_add_test(cases, at_the_edges_a_run_just_creeps_and_just_does_not);
  tcase_add_test(cases, sleep_is_no_pace_to_be_held);
  tcase_add_test(cases, one_window_of_creeping_is_forgiven);
  return suite_run("stall", cases, 20);
}
