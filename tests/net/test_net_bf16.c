// SPDX-License-Identifier: GPL-3.0-or-later
// net/: the arithmetic of bf16, in the form for every processor and, where this one has it, in its own
// instructions.
#include "net_suite.h"

#include "net/kernel/bf16.h"

enum { DRAWS = 60, SAMPLES = 300 };

static int kernels(const NetKernel_f32 *found[2]) {
  int count = 0;
  found[count++] = &net_kernel_bf16_emulated;
#if defined(__x86_64__)
  if (net_kernel_bf16_is_native()) found[count++] = &net_kernel_bf16_native;
#endif
  return count;
}

// bf16 has 8 bits: from 1 to 2 its numbers are 1/128 apart.
START_TEST(rounding_goes_to_the_nearest_and_from_the_middle_to_even) {
  const float step = 1.0f / 128;
  ck_assert_float_eq(net_kernel_bf16_round(1), 1);
  ck_assert_float_eq(net_kernel_bf16_round(1 + 0.49f * step), 1);
  ck_assert_float_eq(net_kernel_bf16_round(1 + 0.51f * step), 1 + step);
  ck_assert_float_eq(net_kernel_bf16_round(1 + 0.5f * step), 1);
  ck_assert_float_eq(net_kernel_bf16_round(1 + 1.5f * step), 1 + 2 * step);
  ck_assert_float_eq(net_kernel_bf16_round(-1 - 1.5f * step), -1 - 2 * step);
  ck_assert_float_eq(net_kernel_bf16_round(2 - 0.4f * step), 2);
  ck_assert_float_eq(net_kernel_bf16_round(0), 0);
  ck_assert(isinf(net_kernel_bf16_round(3.4028235e38f)));
  ck_assert(isnan(net_kernel_bf16_round(NAN)));
}
END_TEST

static float *floats(NetRandom *random, int count) {
  float *array = net_memory_zeroed((size_t)count, sizeof *array);
  ck_assert_ptr_nonnull(array);
  for (int k = 0; k < count; k++) array[k] = (float)net_random_between(random, -1, 1);
  return array;
}

// What the sum is, and in `size` what its terms' magnitudes sum to.
static double reference(const NetProduct_f32 *p, int i, int j, double *size) {
  double sum = (p->bias ? (double)p->bias[i] : 0) + (p->base ? (double)p->base[i * p->base_row + j] : 0);
  *size = fabs(sum);
  for (int l = 0; l < p->k; l++) {
    double term = (double)net_kernel_bf16_round(p->a[i * p->a_row + l * p->a_column]) *
                  (double)net_kernel_bf16_round(p->b[l * p->b_row + j]);
    sum += term;
    *size += fabs(term);
  }
  return p->has_relu && !(sum > 0) ? 0 : sum;
}

// Sizes go beyond a block of the kernels in every direction.
static void check_product(const NetKernel_f32 *kernel, NetRandom *random) {
  int m = 1 + net_suite_below(random, 2 * NET_BF16_ROWS + 20),
      k = 1 + net_suite_below(random, 2 * NET_BF16_INNER + 20);
  int n = NET_COLUMN_UNIT * (1 + net_suite_below(random, 8)),
      row = n + NET_COLUMN_UNIT * net_suite_below(random, 3);
  bool is_transposed = net_suite_below(random, 2);
  float *a = floats(random, m * k), *b = floats(random, k * row), *base = floats(random, m * row),
        *bias = floats(random, m), *c = floats(random, m * row), *before = floats(random, m * row);
  memcpy(before, c, (size_t)(m * row) * sizeof *before);
  NetProduct_f32 product = {.m = m,
                            .n = n,
                            .k = k,
                            .a = a,
                            .a_row = is_transposed ? 1 : k,
                            .a_column = is_transposed ? m : 1,
                            .b = b,
                            .b_row = row,
                            .base = net_suite_below(random, 2) ? base : NULL,
                            .base_row = row,
                            .bias = net_suite_below(random, 2) ? bias : NULL,
                            .c = c,
                            .c_row = row,
                            .has_relu = net_suite_below(random, 2)};
  kernel->product(&product);
  for (int i = 0; i < m; i++)
    for (int j = 0; j < row; j++) {
      double size = 0, expected = j < n ? reference(&product, i, j, &size) : (double)before[i * row + j];
      ck_assert_near((double)c[i * row + j], expected, (k + 2) * 6e-8 * size);
    }
  float *arrays[] = {a, b, base, bias, c, before};
  for (int q = 0; q < 6; q++) net_memory_free(arrays[q]);
}

START_TEST(products_are_sums_in_float_of_rounded_factors) {
  const NetKernel_f32 *found[2];
  int count = kernels(found);
  for (int q = 0; q < count; q++) {
    NetRandom random = net_random_seeded(21, 0);
    for (int draw = 0; draw < DRAWS; draw++) check_product(found[q], &random);
  }
}
END_TEST

// 1/3 and 3 need more bits than bf16 has; the float kernel's product is 1, the rounded one is not.
START_TEST(products_with_the_input_itself_are_not_rounded) {
  const NetKernel_f32 *found[2];
  int count = kernels(found);
  _Alignas(64) float b[NET_COLUMN_UNIT], c[NET_COLUMN_UNIT];
  const float third = 1.0f / 3;
  for (int j = 0; j < NET_COLUMN_UNIT; j++) b[j] = 3;
  NetProduct_f32 product = {.m = 1,
                            .n = NET_COLUMN_UNIT,
                            .k = 1,
                            .a = &third,
                            .a_row = 1,
                            .a_column = 1,
                            .b = b,
                            .b_row = NET_COLUMN_UNIT,
                            .c = c,
                            .c_row = NET_COLUMN_UNIT};
  for (int q = 0; q < count; q++) {
    product.is_raw = true;
    found[q]->product(&product);
    for (int j = 0; j < NET_COLUMN_UNIT; j++) ck_assert_float_eq(c[j], 1);
    product.is_raw = false;
    found[q]->product(&product);
    for (int j = 0; j < NET_COLUMN_UNIT; j++) ck_assert_float_eq(c[j], 3 * net_kernel_bf16_round(third));
  }
}
END_TEST

// One network with one of the kernels: outputs and their gradient.
typedef struct Results {
  float y[SAMPLES * 2], gx[SAMPLES * 24];
} Results;

static Results *evaluate(const NetShape *shape, const NetKernel_f32 *kernel, int threads) {
  Results *results = net_memory_zeroed(1, sizeof *results);
  float x[SAMPLES * 24], c[SAMPLES * 2];
  NetModel_f32 model;
  NetWork_f32 work;
  ck_assert_ptr_nonnull(results);
  ck_net_ok(net_model_create_f32(shape, &model));
  net_model_initialise_f32(&model, 3);
  NetWorkDef def = {.thread_count = threads, .kernel = NET_KERNEL_BF16};
  ck_net_ok(net_work_create_f32(model.plan, &def, &work));
  if (kernel) work.kernel = kernel;
  NetRandom random = net_random_seeded(14, 0);
  for (int k = 0; k < SAMPLES * 24; k++) x[k] = (float)net_random_between(&random, -1, 1);
  for (int k = 0; k < SAMPLES * 2; k++) c[k] = 1;
  net_forward_gradient_f32(&work, &model, SAMPLES, x, c, results->y, results->gx);
  net_work_destroy_f32(&work);
  net_model_destroy_f32(&model);
  return results;
}

// ‖a − b‖ / ‖b‖
static double distance(int count, const float *a, const float *b) {
  double difference = 0, size = 0;
  for (int k = 0; k < count; k++) {
    difference += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    size += (double)b[k] * (double)b[k];
  }
  return sqrt(difference / size);
}

static NetShape smooth(void) {
  NetShape shape = net_shape_tpn_a();
  shape.activation = NET_SILU; // no kinks, at which roundings could choose another side
  shape.pool = NET_SUM;
  return shape;
}

// A factor is off by 1/256 at most, 1/600 as a rule; ten layers of such, with signs that vary.
START_TEST(a_network_in_bf16_is_near_the_one_in_float_and_so_is_its_gradient) {
  NetShape shape = smooth();
  Results *rounded = evaluate(&shape, NULL, 1),
          *exact = evaluate(&shape, net_kernel_f32(net_kernel_best()), 1);
  double by_value = distance(SAMPLES * 2, rounded->y, exact->y);
  double by_gradient = distance(SAMPLES * 24, rounded->gx, exact->gx);
  ck_assert_msg(by_value > 1e-5 && by_value < 1e-2, "values differ by %g", by_value);
  ck_assert_msg(by_gradient > 1e-5 && by_gradient < 2e-2, "gradients differ by %g", by_gradient);
  net_memory_free(rounded), net_memory_free(exact);
}
END_TEST

// Straight through. At a kink the rounded pass takes its own side, so some samples are off by what a unit
// gives.
START_TEST(a_rectified_network_in_bf16_has_nearly_the_gradient_of_the_one_in_float) {
  NetShape shape = net_shape_tpn_a();
  Results *rounded = evaluate(&shape, NULL, 1),
          *exact = evaluate(&shape, net_kernel_f32(net_kernel_best()), 1);
  int near = 0;
  for (int s = 0; s < SAMPLES; s++) near += distance(24, rounded->gx + 24 * s, exact->gx + 24 * s) < 0.1;
  ck_assert_msg(near > SAMPLES / 2, "only %d of %d gradients are near", near, SAMPLES);
  net_memory_free(rounded), net_memory_free(exact);
}
END_TEST

// Sums in another order now and then round to the neighbouring bf16 in the layer after.
START_TEST(the_emulated_form_gives_what_the_instructions_give) {
  const NetKernel_f32 *found[2];
  if (kernels(found) < 2) {
    suite_skip("this processor has no AVX512-BF16");
    return;
  }
  NetShape shape = smooth();
  Results *emulated = evaluate(&shape, found[0], 1), *native = evaluate(&shape, found[1], 1),
          *exact = evaluate(&shape, net_kernel_f32(net_kernel_best()), 1);
  double between = distance(SAMPLES * 2, emulated->y, native->y),
         rounding = distance(SAMPLES * 2, native->y, exact->y);
  ck_assert_msg(between < 0.2 * rounding, "%g between the two, %g from float", between, rounding);
  net_memory_free(emulated), net_memory_free(native), net_memory_free(exact);
}
END_TEST

START_TEST(bf16_gives_the_same_bits_for_any_number_of_threads) {
  NetShape shape = net_shape_tpn_b();
  Results *one = evaluate(&shape, NULL, 1), *three = evaluate(&shape, NULL, 3);
  ck_assert_mem_eq(one, three, sizeof *one);
  net_memory_free(one), net_memory_free(three);
}
END_TEST

START_TEST(bf16_is_never_chosen_unasked_and_is_refused_in_double) {
  NetShape shape = net_shape_mlp(3, 4, 1, 1);
  NetModel_f64 model;
  NetWork_f64 work;
  ck_assert_int_ne(net_work_default().kernel, NET_KERNEL_BF16);
  ck_assert(net_kernel_is_available(NET_KERNEL_BF16));
  ck_assert_ptr_null(net_kernel_f64(NET_KERNEL_BF16));
  ck_net_ok(net_model_create_f64(&shape, &model));
  NetWorkDef def = {.thread_count = 1, .kernel = NET_KERNEL_BF16};
  ck_net_fails(net_work_create_f64(model.plan, &def, &work), NET_BAD_ARGUMENT, "none of it in double");
  net_model_destroy_f64(&model);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("bf16");
  tcase_add_test(test_case, rounding_goes_to_the_nearest_and_from_the_middle_to_even);
  tcase_add_test(test_case, products_are_sums_in_float_of_rounded_factors);
  tcase_add_test(test_case, products_with_the_input_itself_are_not_rounded);
  tcase_add_test(test_case, a_network_in_bf16_is_near_the_one_in_float_and_so_is_its_gradient);
  tcase_add_test(test_case, a_rectified_network_in_bf16_has_nearly_the_gradient_of_the_one_in_float);
  tcase_add_test(test_case, the_emulated_form_gives_what_the_instructions_give);
  tcase_add_test(test_case, bf16_gives_the_same_bits_for_any_number_of_threads);
  tcase_add_test(test_case, bf16_is_never_chosen_unasked_and_is_refused_in_double);
  return suite_run("net_bf16", test_case, 60);
}
