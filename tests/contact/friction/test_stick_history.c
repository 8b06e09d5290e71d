// SPDX-License-Identifier: GPL-3.0-or-later
// contact/friction/stick: what it remembers of a pair, and what it tells of slip, way and work at vertices.
#include "contact/friction/stick_pair.h"

START_TEST(evaluating_leaves_no_trace) {
  Fixture *f = start(1, true);
  shift(f, 0, 1e-3, 0, 0);
  eval(f);
  accept(f);
  eval(f);
  Vec3 first = pull_of(f);
  shift(f, 0, 0.2, 0.3, 0);
  eval(f);
  ck_assert(vec3_length(vec3_sub(pull_of(f), first)) > 0.1);
  memcpy(f->x, f->before, sizeof f->x);
  eval(f);
  Vec3 again = pull_of(f);
  ck_assert_int_eq(memcmp(&first, &again, sizeof first), 0);
  finish(f);
}
END_TEST

START_TEST(a_history_that_is_copied_goes_on_to_the_bit) {
  Fixture *f = start(0.5, true), *other = start(0.5, true);
  shift(f, 0, 1e-3, 7e-4, 0);
  eval(f);
  accept(f);
  ck_assert_int_eq(history_of(f).entry_count, 8);
  free(other->history);
  other->history_count = f->history_count;
  other->history = malloc(f->history_count * sizeof *f->history);
  memcpy(other->history, f->history, f->history_count * sizeof *f->history);
  memcpy(other->before, f->before, sizeof f->before);
  memcpy(other->x, f->x, sizeof f->x);
  shift(f, 0, 1e-4, 0, 0);
  shift(other, 0, 1e-4, 0, 0);
  eval(f);
  eval(other);
  ck_assert_int_eq(memcmp(f->stick.forces, other->stick.forces, sizeof *f->stick.forces), 0);
  ck_assert_int_eq(memcmp(f->stick.pulls, other->stick.pulls, sizeof *f->stick.pulls), 0);
  ck_assert(f->stick.stored == other->stick.stored && f->stick.spent == other->stick.spent);
  finish(f);
  finish(other);
}
END_TEST

START_TEST(numbers_that_are_no_history_are_refused) {
  Fixture *f = start(0.5, true);
  ck_assert_ok(contact_stick_history_check(1, 8, f->history, f->history_count));
  ck_assert_int_eq(contact_stick_history_check(1, 8, f->history, f->history_count - 1), STATUS_INPUT);
  ck_assert_int_eq(contact_stick_history_check(1, 7, f->history, f->history_count), STATUS_INPUT);
  ck_assert_int_eq(contact_stick_history_check(1, 8, f->history, 3), STATUS_INPUT);
  finish(f);
}
END_TEST

START_TEST(what_lifts_off_loses_its_spring) {
  Fixture *f = start(1, true);
  shift(f, 0, 2e-3, 0, 0);
  eval(f);
  double stored = f->stick.stored;
  accept(f);
  ck_assert_int_eq(history_of(f).entry_count, 4);
  eval_pairs(f, 0, NULL);
  ck_assert(stored > 0);
  ck_assert_near(f->stick.spent, stored, 1e-12 * stored);
  ck_assert_near(f->stick.stored, 0, 0);
  accept(f);
  ck_assert_near(*history_of(f).dissipated, stored, 1e-12 * stored);
  for (int e = 0; e < history_of(f).entry_count; e++) {
    ck_assert_double_eq(history_of(f).entries[e].energy, 0);
    ck_assert_double_eq(history_of(f).entries[e].limit, 0);
  }
  finish(f);
}
END_TEST

typedef struct Sums {
  double weights[8][2], slips[8][3], ways[8], works[8];
  double work; // of all vertices
} Sums;

// What is told at the state that was evaluated last.
static void tell(const Fixture *f, const bool *is_resting, Sums *sums) {
  static const double DEPTHS[8] = {0};
  const ContactStickHistory history = history_of(f);
  *sums = (Sums){0};
  contact_stick_tell(
      &f->stick, &history, is_resting, DEPTHS,
      &(ContactStickTold){
          .weights = sums->weights, .slips = sums->slips, .ways = sums->ways, .works = sums->works});
  for (int v = 0; v < 8; v++) sums->work += sums->works[v];
}

// There and back by more than the spring bears: the way is twice as long as the slip is short, and what the
// vertices dissipated is what the law did.
START_TEST(slip_way_and_work_are_told_at_the_vertices_of_the_slave) {
  Fixture *f = start(1, true);
  Sums sums;
  double way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  f->meet[0] += way; // the same of A touches
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.work, f->stick.spent, 1e-12 * f->stick.spent);
  for (int v = 0; v < 8; v++) {
    ck_assert_near(sums.ways[v], v < 4 ? way - elastic : 0, 1e-12);
    ck_assert_near(sums.slips[v][0], v < 4 ? way - elastic : 0, 1e-12);
    ck_assert_double_gt(sums.weights[v][1], 0); // both sides slide
    ck_assert_double_eq(sums.weights[v][0], 0);
  }
  accept(f);
  shift(f, 0, -way, 0, 0);
  f->meet[0] -= way;
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.ways[0], 2 * way - 3 * elastic, 1e-12);
  ck_assert_near(sums.slips[0][0], elastic, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
  finish(f);
}
END_TEST

// What has left keeps its way and its work, with what its spring had stored; what comes back begins its slip
// anew.
START_TEST(way_and_work_outlast_the_contact_and_slip_does_not) {
  Fixture *f = start(1, true);
  Sums sums;
  double way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  eval_pairs(f, 0, NULL);
  for (int k = 0; k < 3; k++) {
    tell(f, NULL, &sums);
    ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
    ck_assert_near(sums.ways[0], way - elastic, 1e-12);
    ck_assert_near(sums.slips[0][0], 0, 0);
    accept(f);
    eval_pairs(f, 0, NULL);
  }
  ck_assert_int_eq(history_of(f).entry_count, 4);
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.slips[0][0], 0, 1e-12);
  ck_assert_near(sums.ways[0], way - elastic, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
  finish(f);
}
END_TEST

// The slip turns with the body, as the spring does.
START_TEST(slip_turns_with_its_body_and_stays_at_rest) {
  Fixture *f = start(1, true);
  const bool is_resting = true;
  Sums sums;
  double R[9], way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  make_rotation(1, R);
  rotate(f, R);
  eval(f);
  tell(f, NULL, &sums);
  Vec3 expected = turn(R, (const double[]){way - elastic, 0, 0});
  ck_assert_near(vec3_length(vec3_sub(vec3_at(sums.slips[0]), expected)), 0, 1e-12);
  accept(f);
  eval_pairs(f, 0, &is_resting);
  tell(f, &is_resting, &sums);
  ck_assert_near(vec3_length(vec3_sub(vec3_at(sums.slips[0]), expected)), 0, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated, 1e-12 * sums.work);
  finish(f);
}
END_TEST

START_TEST(what_rests_keeps_its_history) {
  Fixture *f = start(1, true);
  const bool is_resting = true;
  shift(f, 0, 2e-3, 0, 0);
  eval(f);
  accept(f);
  double stretch[3], stored = f->stick.stored;
  Vec3 pull = pull_of(f);
  memcpy(stretch, history_of(f).entries[0].stretch, sizeof stretch);
  eval_pairs(f, 0, &is_resting);
  ck_assert_near(f->stick.stored, stored, 1e-15);
  ck_assert_near(f->stick.spent, 0, 0);
  ck_assert_near(pull_of(f).x, pull.x, 0);
  accept_resting(f, &is_resting);
  ck_assert_int_eq(history_of(f).entry_count, 4);
  ck_assert_int_eq(memcmp(stretch, history_of(f).entries[0].stretch, sizeof stretch), 0);
  finish(f);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("stick_history");
  tcase_add_test(test_case, evaluating_leaves_no_trace);
  tcase_add_test(test_case, a_history_that_is_copied_goes_on_to_the_bit);
  tcase_add_test(test_case, numbers_that_are_no_history_are_refused);
  tcase_add_test(test_case, what_lifts_off_loses_its_spring);
  tcase_add_test(test_case, slip_way_and_work_are_told_at_the_vertices_of_the_slave);
  tcase_add_test(test_case, way_and_work_outlast_the_contact_and_slip_does_not);
  tcase_add_test(test_case, slip_turns_with_its_body_and_stays_at_rest);
  tcase_add_test(test_case, what_rests_keeps_its_history);
  return suite_run("stick_history", test_case, 30);
}
