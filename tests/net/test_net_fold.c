// SPDX-License-Identifier: GPL-3.0-or-later
// net/fold: a network whose first tetrahedron is folded into constants against the whole one, in double, over
// networks of random shape.
#include "net_suite.h"

enum { SHAPES = 30, SAMPLES = 5, TANGENTS = 2 };

static const double first[12] = {0.1, 0.2, -0.3, 1.1, 0, 0.2, -0.1, 0.9, 0.1, 0.2, 0.1, 0.8};

// The same samples for both: (first, second) and second alone, with directions and weights of outputs.
typedef struct Case {
  NetModel_f64 whole, folded;
  NetWork_f64 whole_work, folded_work;
  double x[SAMPLES * 24], xt[SAMPLES * TANGENTS * 24], c[SAMPLES * 2];
  double second[SAMPLES * 12], second_t[SAMPLES * TANGENTS * 12];
} Case;

static void fill(Case *made, NetRandom *random) {
  for (int s = 0; s < SAMPLES; s++)
    for (int i = 0; i < 24; i++) {
      double value = i < 12 ? first[i] : net_random_between(random, -1, 1);
      made->x[24 * s + i] = value;
      if (i >= 12) made->second[12 * s + i - 12] = value;
    }
  for (int s = 0; s < SAMPLES * TANGENTS; s++)
    for (int i = 12; i < 24; i++)
      made->xt[24 * s + i] = made->second_t[12 * s + i - 12] = net_random_between(random, -1, 1);
  for (int s = 0; s < SAMPLES * 2; s++) made->c[s] = net_random_between(random, -1, 1);
}

static Case make_case(int index) {
  NetRandom random = net_random_seeded(31, (uint64_t)index);
  NetShape shape = net_suite_shape(&random, NET_TPN);
  shape.has_one_tetrahedron = false, shape.input_count = 24;
  Case made = {.whole = net_suite_model(&shape, (uint64_t)index)};
  ck_net_ok(net_fold_create_f64(&made.whole, first, &made.folded));
  made.whole_work = net_suite_work(&made.whole, 1, TANGENTS, SAMPLES);
  made.folded_work = net_suite_work(&made.folded, 1, TANGENTS, SAMPLES);
  fill(&made, &random);
  return made;
}

static void destroy_case(Case *used) {
  net_work_destroy_f64(&used->whole_work), net_work_destroy_f64(&used->folded_work);
  net_model_destroy_f64(&used->whole), net_model_destroy_f64(&used->folded);
}

static void check_near(int count, const double *a, const double *b) {
  double scale = 1;
  for (int k = 0; k < count; k++) scale = fmax(scale, fabs(b[k]));
  for (int k = 0; k < count; k++) ck_assert_near(a[k], b[k], 1e-12 * scale);
}

START_TEST(a_folded_network_gives_the_whole_ones_outputs_and_derivatives) {
  for (int index = 0; index < SHAPES; index++) {
    Case used = make_case(index);
    double y[2][SAMPLES * 2], gx[SAMPLES * 24], folded_gx[SAMPLES * 12];
    net_forward_gradient_f64(&used.whole_work, &used.whole, SAMPLES, used.x, used.c, y[0], gx);
    net_forward_gradient_f64(&used.folded_work, &used.folded, SAMPLES, used.second, used.c, y[1], folded_gx);
    check_near(SAMPLES * 2, y[1], y[0]);
    for (int s = 0; s < SAMPLES; s++) check_near(12, folded_gx + 12 * s, gx + 24 * s + 12);
    destroy_case(&used);
  }
}
END_TEST

START_TEST(a_folded_network_gives_the_whole_ones_tangents_and_second_derivatives) {
  for (int index = 0; index < SHAPES; index++) {
    Case used = make_case(index);
    double y[SAMPLES * 2], yt[2][SAMPLES * TANGENTS * 2], gx[SAMPLES * 24],
        second[2][SAMPLES * TANGENTS * TANGENTS];
    net_tangent_second_f64(&used.whole_work, &used.whole, SAMPLES, TANGENTS, used.x, used.xt, used.c, y,
                           yt[0], gx, second[0]);
    net_tangent_second_f64(&used.folded_work, &used.folded, SAMPLES, TANGENTS, used.second, used.second_t,
                           used.c, y, yt[1], gx, second[1]);
    check_near(SAMPLES * TANGENTS * 2, yt[1], yt[0]);
    check_near(SAMPLES * TANGENTS * TANGENTS, second[1], second[0]);
    destroy_case(&used);
  }
}
END_TEST

// Where the constant and the second tetrahedron tie, the pool follows the first, as the whole network does:
// here all features tie, so of the second one only the skip's part is left.
START_TEST(at_a_tie_the_first_tetrahedron_is_followed) {
  NetShape shape = net_shape_tpn_a();
  NetModel_f64 whole = net_suite_model(&shape, 5), folded;
  NetWork_f64 whole_work = net_suite_work(&whole, 1, 0, 0), folded_work;
  ck_net_ok(net_fold_create_f64(&whole, first, &folded));
  folded_work = net_suite_work(&folded, 1, 0, 0);
  double x[24], y[2][2], gx[24], folded_gx[12];
  const double c[2] = {1, 1};
  for (int i = 0; i < 24; i++) x[i] = first[i % 12];
  net_forward_gradient_f64(&whole_work, &whole, 1, x, c, y[0], gx);
  net_forward_gradient_f64(&folded_work, &folded, 1, first, c, y[1], folded_gx);
  check_near(2, y[1], y[0]);
  check_near(12, folded_gx, gx + 12);
  net_work_destroy_f64(&whole_work), net_work_destroy_f64(&folded_work);
  net_model_destroy_f64(&whole), net_model_destroy_f64(&folded);
}
END_TEST

// Paper's reading (a), by hand: per pair 4 vertices of 3·24 + 24·24 + 3·24, a tetrahedron of 27·48 + 48·48 +
// 12·48 and 12·96 of the skip are left out of 81,600 multiplications.
START_TEST(half_of_the_layers_before_the_pair_are_left_out) {
  NetShape shape = net_shape_tpn_a();
  NetPlan whole, folded;
  ck_net_ok(net_plan_create(&shape, &whole));
  ck_net_ok(net_plan_create_folded(&shape, &folded));
  ck_assert_double_eq(whole.flops, 2.0 * 81600);
  ck_assert_double_eq(whole.flops - folded.flops, 2.0 * (4 * 720 + 4176 + 1152));
}
END_TEST

START_TEST(what_cannot_be_folded_is_refused) {
  NetShape shape = net_shape_mlp(24, 4, 1, 2);
  NetModel_f64 model, folded, twice;
  ck_net_ok(net_model_create_f64(&shape, &model));
  ck_net_fails(net_fold_create_f64(&model, first, &folded), NET_BAD_ARGUMENT, "must be a tpn");
  net_model_destroy_f64(&model);
  shape = net_shape_tpn_a();
  ck_net_ok(net_model_create_f64(&shape, &model));
  ck_net_ok(net_fold_create_f64(&model, first, &folded));
  ck_net_fails(net_fold_create_f64(&folded, first, &twice), NET_BAD_ARGUMENT, "24 inputs");
  net_model_destroy_f64(&model), net_model_destroy_f64(&folded);
}
END_TEST

START_TEST(every_allocation_may_fail) {
  NetShape shape = net_shape_tpn_a();
  NetModel_f64 model, folded;
  ck_net_ok(net_model_create_f64(&shape, &model));
  for (long k = 1; k <= 6; k++) {
    net_memory_fail_at(k);
    NetStatus status = net_fold_create_f64(&model, first, &folded);
    net_memory_fail_at(0);
    ck_assert_int_eq(status, NET_NO_MEMORY);
    ck_assert_ptr_null(folded.parameters);
  }
  net_model_destroy_f64(&model);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("fold");
  tcase_add_test(test_case, a_folded_network_gives_the_whole_ones_outputs_and_derivatives);
  tcase_add_test(test_case, a_folded_network_gives_the_whole_ones_tangents_and_second_derivatives);
  tcase_add_test(test_case, at_a_tie_the_first_tetrahedron_is_followed);
  tcase_add_test(test_case, half_of_the_layers_before_the_pair_are_left_out);
  tcase_add_test(test_case, what_cannot_be_folded_is_refused);
  tcase_add_test(test_case, every_allocation_may_fail);
  return suite_run("net_fold", test_case, 60);
}
