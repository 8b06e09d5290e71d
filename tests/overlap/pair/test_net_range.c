// SPDX-License-Identifier: GPL-3.0-or-later
// The range of pairs that a network was trained on.
#include <string.h>

#include "base/random.h"
#include "overlap/pair/range.h"
#include "suite.h"

static const double simplices[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2};

START_TEST(measures_of_simplices_are_those_by_hand) {
  OverlapRangeMeasures measures = overlap_range_measure(simplices);
  ck_assert_near(measures.volume[0], 1.0 / 6, 1e-15);
  ck_assert_near(measures.volume[1], 8.0 / 6, 1e-15);
  // squares of distances from (¼, ¼, ¼): twice 3/16, thrice 11/16, thrice 51/16
  ck_assert_near(measures.radius, sqrt((2 * 3 + 3 * 11 + 3 * 51) / 16.0 / 8), 1e-15);
}
END_TEST

START_TEST(range_leaves_out_half_a_percent_at_each_end) {
  enum { COUNT = 1000 };
  static OverlapRangeMeasures measures[COUNT];
  static double overlaps[COUNT], values[COUNT];
  for (int i = 0; i < COUNT; i++) {
    int k = (i * 7 + 3) % COUNT; // 0 … 999 in another order
    measures[i] = (OverlapRangeMeasures){.radius = 1 + k, .volume = {2.0 + k, 5000.0 - k}};
    overlaps[i] = k < 600 ? 0 : k;
  }
  OverlapRange range = overlap_range_of(COUNT, measures, overlaps, values);
  ck_assert(range.radius[0] == 6 && range.radius[1] == 995);
  ck_assert(range.volume[0][0] == 7 && range.volume[0][1] == 996);
  ck_assert(range.volume[1][0] == 4006 && range.volume[1][1] == 4995);
  ck_assert(range.overlap == 997); // of 400 overlaps, two are left out
}
END_TEST

START_TEST(text_is_read_as_it_is_written) {
  OverlapRange range = {{0.5, 7}, {{0.125, 2}, {1e-6, 30}}, 0.0625}, again;
  char text[OVERLAP_RANGE_TEXT];
  overlap_range_print(&range, text);
  ck_assert(overlap_range_parse(text, &again));
  ck_assert(memcmp(&range, &again, sizeof range) == 0);
  strcat(text, "!");
  ck_assert(!overlap_range_parse(text, &again));
  ck_assert(!overlap_range_parse("normalised coordinates in [-3, 4]", &again));
  range.radius[1] = 0.25; // ends in the wrong order
  overlap_range_print(&range, text);
  ck_assert(!overlap_range_parse(text, &again));
}
END_TEST

static OverlapRange tight(void) {
  return (OverlapRange){{0.9, 1.1}, {{0.1, 0.12}, {0.15, 0.2}}, 0.01};
}

START_TEST(weight_is_one_inside_and_nought_far_outside) {
  OverlapRange range = {{0.5, 2}, {{0.1, 0.2}, {0.5, 2}}, 0.01};
  double pair[24];
  OverlapBend at_end, above;
  memcpy(pair, simplices, sizeof pair);
  ck_assert(overlap_range_weight(&range, pair, NULL, NULL) == 1);
  // the unit simplex is as large as nine digits of its volume say
  range.volume[0][0] = range.volume[0][1] = 0.166666667;
  ck_assert(overlap_range_weight(&range, pair, NULL, NULL) == 1);
  for (int i = 12; i < 24; i++) pair[i] *= 3;
  ck_assert(overlap_range_weight(&range, pair, NULL, NULL) == 0);
  pair[12] = NAN;
  ck_assert(overlap_range_weight(&range, pair, NULL, NULL) == 0);
  at_end = overlap_range_overlap_weight(&range, 0.01);
  above = overlap_range_overlap_weight(&range, 0.0151);
  ck_assert(at_end.value == 1 && at_end.slope == 0 && above.value == 0 && above.slope == 0);
  ck_assert(overlap_range_overlap_weight(&range, NAN).value == 0);
}
END_TEST

START_TEST(both_derivatives_are_those_of_the_weight) {
  OverlapRange range = tight();
  Random random = random_seeded(5, 0);
  int between = 0, wrong = 0;
  for (int n = 0; n < 4000; n++) {
    double pair[24], gradient[24], hessian[576], rise[24], fall[24];
    for (int i = 0; i < 24; i++)
      pair[i] = simplices[i] * (i < 12 ? 0.9 : 0.53) + 0.2 * random_uniform(&random);
    double weight = overlap_range_weight(&range, pair, gradient, hessian);
    ck_assert(weight >= 0 && weight <= 1);
    between += weight > 0.05 && weight < 0.95;
    for (int i = 0; i < 24; i++) {
      double step = 1e-6, kept = pair[i];
      pair[i] = kept + step;
      double above = overlap_range_weight(&range, pair, rise, NULL);
      pair[i] = kept - step;
      double below = overlap_range_weight(&range, pair, fall, NULL);
      pair[i] = kept;
      ck_assert_near((above - below) / (2 * step), gradient[i], 2e-3);
      for (int j = 0; j < 24; j++) // it jumps at the ends of a band
        wrong += fabs((rise[j] - fall[j]) / (2 * step) - hessian[24 * j + i]) > 1e-2;
    }
  }
  ck_assert_int_ge(between, 100);
  ck_assert_msg(wrong < 4000 * 576 / 1000, "%d of %d second derivatives", wrong, 4000 * 576);
  for (double overlap = 0.0101; overlap < 0.015; overlap += 3e-4) {
    double step = 1e-8;
    OverlapBend here = overlap_range_overlap_weight(&range, overlap),
                after = overlap_range_overlap_weight(&range, overlap + step),
                before = overlap_range_overlap_weight(&range, overlap - step);
    ck_assert_near((after.value - before.value) / (2 * step), here.slope, 1e-3);
    ck_assert_near((after.slope - before.slope) / (2 * step), here.bend, 1e-2 * fabs(here.bend) + 1e-3);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_range");
  tcase_add_test(test_case, measures_of_simplices_are_those_by_hand);
  tcase_add_test(test_case, range_leaves_out_half_a_percent_at_each_end);
  tcase_add_test(test_case, text_is_read_as_it_is_written);
  tcase_add_test(test_case, weight_is_one_inside_and_nought_far_outside);
  tcase_add_test(test_case, both_derivatives_are_those_of_the_weight);
  return suite_run("net_range", test_case, 30);
}
