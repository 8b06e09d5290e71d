// SPDX-License-Identifier: GPL-3.0-or-later
// At the edge of each limit: a step that just stands, and one that just does not.
#include <math.h>
#include <string.h>

#include "fem/model/limits.h"
#include "fem/time/verdict.h"
#include "suite.h"

static const double LESS = 1 - 1e-6, MORE = 1 + 1e-6;

// A step of a second that nothing speaks against.
static FemFindings good(void) {
  return (FemFindings){
      .length = 1, .shortest = 1e-9, .resolved = 1e-3, .rebound = 1e-4, .is_evaluated = true};
}

START_TEST(a_step_that_nothing_speaks_against_stands) {
  FemFindings findings = good();
  FemVerdict verdict = fem_verdict_of(&findings);
  ck_assert(verdict.stands);
  ck_assert_int_eq(verdict.cause, FEM_CAUSE_NONE);
}
END_TEST

START_TEST(friction_at_a_reversal_may_give_two_tenths_of_the_promise) {
  FemFindings findings = good();
  findings.reversed = LESS * 2e-4;
  ck_assert(fem_verdict_of(&findings).stands);
  findings.reversed = MORE * 2e-4;
  ck_assert(!fem_verdict_of(&findings).stands);
  ck_assert_int_eq(fem_verdict_of(&findings).cause, FEM_CAUSE_REVERSAL);
  findings.reversed = NAN;
  ck_assert(!fem_verdict_of(&findings).stands);
}
END_TEST

START_TEST(each_cause_alone_is_enough_and_the_first_is_named) {
  FemFindings findings = good();
  findings.reversed = 1;
  findings.differs_from_motion = true;
  ck_assert_int_eq(fem_verdict_of(&findings).cause, FEM_CAUSE_MOMENTUM);
  findings.gains_energy = true;
  ck_assert_int_eq(fem_verdict_of(&findings).cause, FEM_CAUSE_ENERGY);
  findings.is_evaluated = false;
  ck_assert_int_eq(fem_verdict_of(&findings).cause, FEM_CAUSE_FORCES);
  for (int cause = FEM_CAUSE_FORCES; cause <= FEM_CAUSE_REVERSAL; cause++)
    ck_assert_uint_gt(strlen(fem_verdict_words((FemCause)cause)), 0);
}
END_TEST

START_TEST(a_step_that_does_not_stand_is_tried_with_a_fifth_of_its_length) {
  FemFindings findings = good();
  findings.gains_energy = true;
  ck_assert_double_eq(fem_verdict_of(&findings).step, 0.2);
}
END_TEST

// A step in which nothing moves stands; one that is just longer is tried with what is worth trying. In less
// time than a wave moves anything in, a stiff contact gives energy.
START_TEST(no_step_is_tried_in_which_nothing_moves) {
  for (int k = 0; k < 2; k++) {
    FemFindings findings = good();
    findings.gains_energy = k == 0, findings.differs_from_motion = k == 1;
    const double least = k == 0 ? findings.rebound : findings.resolved;
    findings.length = MORE * least;
    ck_assert(!fem_verdict_of(&findings).stands);
    ck_assert_double_eq(fem_verdict_of(&findings).step, least);
    findings.length = LESS * least;
    ck_assert(fem_verdict_of(&findings).stands);
    ck_assert_int_eq(fem_verdict_of(&findings).cause, k == 0 ? FEM_CAUSE_ENERGY : FEM_CAUSE_MOMENTUM);
  }
}
END_TEST

// Nor one that the scene does not allow (time.min_step).
START_TEST(no_step_is_tried_that_is_shorter_than_allowed) {
  FemFindings findings = good();
  findings.differs_from_motion = true;
  findings.shortest = 0.5;
  ck_assert_double_eq(fem_verdict_of(&findings).step, 0.5);
  findings.shortest = 1;
  ck_assert(fem_verdict_of(&findings).stands);
}
END_TEST

// Without forces there is no way but shorter steps, down to the shortest, where the run fails.
START_TEST(a_step_without_forces_never_stands) {
  FemFindings findings = good();
  findings.is_evaluated = false;
  findings.length = LESS * findings.resolved;
  int tries = 0;
  for (FemVerdict verdict; (verdict = fem_verdict_of(&findings)).step > 0; findings.length = verdict.step) {
    ck_assert(!verdict.stands);
    ck_assert_int_lt(++tries, 20);
  }
  ck_assert_double_eq(findings.length, findings.shortest);
  ck_assert(!fem_verdict_of(&findings).stands);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("verdict");
  tcase_add_test(cases, a_step_that_nothing_speaks_against_stands);
  tcase_add_test(cases, friction_at_a_reversal_may_give_two_tenths_of_the_promise);
  tcase_add_test(cases, each_cause_alone_is_enough_and_the_first_is_named);
  tcase_add_test(cases, a_step_that_does_not_stand_is_tried_with_a_fifth_of_its_length);
  tcase_add_test(cases, no_step_is_tried_in_which_nothing_moves);
  tcase_add_test(cases, no_step_is_tried_that_is_shorter_than_allowed);
  tcase_add_test(cases, a_step_without_forces_never_stands);
  return suite_run("verdict", cases, 20);
}
