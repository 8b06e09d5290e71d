// SPDX-License-Identifier: GPL-3.0-or-later
// The range of pairs that a network was trained on.
#include <string.h>

#include "base/random.h"
#include "contact/net_range.h"
#include "suite.h"

static const double simplices[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2};

START_TEST(measures_of_simplices_are_those_by_hand) {
  ContactNetMeasures measures = contact_net_range_measure(simplices);
  ck_assert_near(measures.volume[0], 1.0 / 6, 1e-15);
  ck_assert_near(measures.volume[1], 8.0 / 6, 1e-15);
  // squares of distances from (¼, ¼, ¼): twice 3/16, thrice 11/16, thrice 51/16
  ck_assert_near(measures.radius, sqrt((2 * 3 + 3 * 11 + 3 * 51) / 16.0 / 8), 1e-15);
}
END_TEST

START_TEST(range_leaves_out_half_a_percent_at_each_end) {
  enum { COUNT = 1000 };
  static ContactNetMeasures measures[COUNT];
  static double overlaps[COUNT], values[COUNT];
  for (int i = 0; i < COUNT; i++) {
    int k = (i * 7 + 3) % COUNT; // 0 … 999 in another order
    measures[i] = (ContactNetMeasures){.radius = 1 + k, .volume = {2.0 + k, 5000.0 - k}};
    overlaps[i] = k < 600 ? 0 : k;
  }
  ContactNetRange range = contact_net_range_of(COUNT, measures, overlaps, values);
  ck_assert(range.radius[0] == 6 && range.radius[1] == 995);
  ck_assert(range.volume[0][0] == 7 && range.volume[0][1] == 996);
  ck_assert(range.volume[1][0] == 4006 && range.volume[1][1] == 4995);
  ck_assert(range.overlap == 997); // of 400 overlaps, two are left out
}
END_TEST

START_TEST(text_is_read_as_it_is_written) {
  ContactNetRange range = {{0.5, 7}, {{0.125, 2}, {1e-6, 30}}, 0.0625}, again;
  char text[CONTACT_NET_RANGE_TEXT];
  contact_net_range_print(&range, text);
  ck_assert(contact_net_range_parse(text, &again));
  ck_assert(memcmp(&range, &again, sizeof range) == 0);
  strcat(text, "!");
  ck_assert(!contact_net_range_parse(text, &again));
  ck_assert(!contact_net_range_parse("normalised coordinates in [-3, 4]", &again));
  range.radius[1] = 0.25; // ends in the wrong order
  contact_net_range_print(&range, text);
  ck_assert(!contact_net_range_parse(text, &again));
}
END_TEST

static ContactNetRange tight(void) {
  return (ContactNetRange){{0.9, 1.1}, {{0.1, 0.12}, {0.15, 0.2}}, 0.01};
}

START_TEST(weight_is_one_inside_and_nought_far_outside) {
  ContactNetRange range = {{0.5, 2}, {{0.1, 0.2}, {0.5, 2}}, 0.01};
  double pair[24], slope;
  memcpy(pair, simplices, sizeof pair);
  ck_assert(contact_net_range_weight(&range, pair, NULL) == 1);
  // the unit simplex is as large as nine digits of its volume say
  range.volume[0][0] = range.volume[0][1] = 0.166666667;
  ck_assert(contact_net_range_weight(&range, pair, NULL) == 1);
  for (int i = 12; i < 24; i++) pair[i] *= 3;
  ck_assert(contact_net_range_weight(&range, pair, NULL) == 0);
  pair[12] = NAN;
  ck_assert(contact_net_range_weight(&range, pair, NULL) == 0);
  ck_assert(contact_net_range_overlap_weight(&range, 0.01, &slope) == 1 && slope == 0);
  ck_assert(contact_net_range_overlap_weight(&range, 0.0151, &slope) == 0 && slope == 0);
  ck_assert(contact_net_range_overlap_weight(&range, NAN, &slope) == 0);
}
END_TEST

START_TEST(gradient_is_that_of_the_weight) {
  ContactNetRange range = tight();
  Random random = random_seeded(5, 0);
  int between = 0;
  for (int n = 0; n < 4000; n++) {
    double pair[24], gradient[24];
    for (int i = 0; i < 24; i++)
      pair[i] = simplices[i] * (i < 12 ? 0.9 : 0.53) + 0.2 * random_uniform(&random);
    double weight = contact_net_range_weight(&range, pair, gradient);
    ck_assert(weight >= 0 && weight <= 1);
    between += weight > 0.05 && weight < 0.95;
    for (int i = 0; i < 24; i++) {
      double step = 1e-6, kept = pair[i];
      pair[i] = kept + step;
      double above = contact_net_range_weight(&range, pair, NULL);
      pair[i] = kept - step;
      double below = contact_net_range_weight(&range, pair, NULL);
      pair[i] = kept;
      ck_assert_near((above - below) / (2 * step), gradient[i], 2e-3);
    }
  }
  ck_assert_int_ge(between, 100);
  for (double overlap = 0.0101; overlap < 0.015; overlap += 3e-4) {
    double slope, unused, step = 1e-8;
    contact_net_range_overlap_weight(&range, overlap, &slope);
    double difference = contact_net_range_overlap_weight(&range, overlap + step, &unused) -
                        contact_net_range_overlap_weight(&range, overlap - step, &unused);
    ck_assert_near(difference / (2 * step), slope, 1e-3);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_range");
  tcase_add_test(test_case, measures_of_simplices_are_those_by_hand);
  tcase_add_test(test_case, range_leaves_out_half_a_percent_at_each_end);
  tcase_add_test(test_case, text_is_read_as_it_is_written);
  tcase_add_test(test_case, weight_is_one_inside_and_nought_far_outside);
  tcase_add_test(test_case, gradient_is_that_of_the_weight);
  return suite_run("net_range", test_case, 30);
}
