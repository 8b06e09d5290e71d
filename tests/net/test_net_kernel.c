// SPDX-License-Identifier: GPL-3.0-or-later
// net/: every kernel against the plain definition, and all kernels that this processor runs against each
// other.
#include "net_suite.h"

enum { DRAWS = 60 };

static double reference(const NetProduct_f64 *p, int i, int j) {
  double sum = (p->bias ? p->bias[i] : 0) + (p->base ? p->base[i * p->base_row + j] : 0);
  for (int l = 0; l < p->k; l++) sum += p->a[i * p->a_row + l * p->a_column] * p->b[l * p->b_row + j];
  return p->has_relu && !(sum > 0) ? 0 : sum;
}

static void check_product(const NetKernel_f64 *kernel, NetRandom *random) {
  int m = 1 + net_suite_below(random, 40), k = 1 + net_suite_below(random, 40);
  int n = NET_COLUMN_UNIT * (1 + net_suite_below(random, 8)),
      row = n + NET_COLUMN_UNIT * net_suite_below(random, 3);
  bool is_transposed = net_suite_below(random, 2);
  double *a = net_suite_array(random, m * k, 1), *b = net_suite_array(random, k * row, 1);
  double *base = net_suite_array(random, m * row, 1), *bias = net_suite_array(random, m, 1);
  double *c = net_suite_array(random, m * row, 1),
         *before = net_memory_zeroed((size_t)(m * row), sizeof *before);
  memcpy(before, c, (size_t)(m * row) * sizeof *before);
  NetProduct_f64 product = {.m = m,
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
    for (int j = 0; j < row; j++)
      ck_assert_near(c[i * row + j], j < n ? reference(&product, i, j) : before[i * row + j],
                     1e-13 * (k + 2));
  double *arrays[] = {a, b, base, bias, c, before};
  for (int q = 0; q < 6; q++) net_memory_free(arrays[q]);
}

START_TEST(products_are_what_their_definition_says) {
  for (int kind = 0; kind < NET_KERNEL_COUNT; kind++) {
    const NetKernel_f64 *kernel = net_kernel_f64((NetKernelKind)kind);
    if (!kernel) continue;
    NetRandom random = net_random_seeded(11, 0);
    for (int draw = 0; draw < DRAWS; draw++) check_product(kernel, &random);
  }
}
END_TEST

START_TEST(outer_products_and_row_sums_are_added) {
  for (int kind = 0; kind < NET_KERNEL_COUNT; kind++) {
    const NetKernel_f64 *kernel = net_kernel_f64((NetKernelKind)kind);
    if (!kernel) continue;
    NetRandom random = net_random_seeded(12, 0);
    for (int draw = 0; draw < DRAWS; draw++) {
      int m = 1 + net_suite_below(&random, 20), k = 1 + net_suite_below(&random, 20);
      int n = NET_COLUMN_UNIT * (1 + net_suite_below(&random, 8)), row = n + NET_COLUMN_UNIT;
      double *a = net_suite_array(&random, m * row, 1), *b = net_suite_array(&random, k * row, 1);
      double *c = net_suite_array(&random, m * k, 0), *sums = net_suite_array(&random, m, 0);
      for (int i = 0; i < m * k; i++) c[i] = i;
      for (int i = 0; i < m; i++) sums[i] = i;
      kernel->outer(m, k, n, a, row, b, row, c);
      kernel->row_sums(m, n, a, row, sums);
      for (int i = 0; i < m; i++) {
        double sum = i;
        for (int j = 0; j < n; j++) sum += a[i * row + j];
        ck_assert_near(sums[i], sum, 1e-12);
        for (int l = 0; l < k; l++) {
          double expected = i * k + l;
          for (int j = 0; j < n; j++) expected += a[i * row + j] * b[l * row + j];
          ck_assert_near(c[i * k + l], expected, 1e-11);
        }
      }
      net_memory_free(a), net_memory_free(b), net_memory_free(c), net_memory_free(sums);
    }
  }
}
END_TEST

// x σ(x) against the C library's exponential, over all magnitudes.
START_TEST(silu_agrees_with_the_c_library) {
  for (int kind = 0; kind < NET_KERNEL_COUNT; kind++) {
    const NetKernel_f64 *kernel = net_kernel_f64((NetKernelKind)kind);
    const NetKernel_f32 *single = net_kernel_f32((NetKernelKind)kind);
    if (!kernel) continue;
    NetRandom random = net_random_seeded(13, 0);
    for (int draw = 0; draw < 200; draw++) {
      double z[NET_COLUMN_UNIT], a[NET_COLUMN_UNIT];
      float zf[NET_COLUMN_UNIT], af[NET_COLUMN_UNIT];
      for (int k = 0; k < NET_COLUMN_UNIT; k++) {
        z[k] = net_random_between(&random, -1, 1) * exp(net_random_between(&random, -12, 6));
        zf[k] = (float)z[k];
      }
      kernel->silu(1, NET_COLUMN_UNIT, 0, z, a);
      single->silu(1, NET_COLUMN_UNIT, 0, zf, af);
      for (int k = 0; k < NET_COLUMN_UNIT; k++) {
        double exact = z[k] / (1 + exp(-z[k])), rounded = (double)zf[k] / (1 + exp(-(double)zf[k]));
        ck_assert_near(a[k], exact, 4e-16 * (fabs(exact) + fabs(z[k] * exact)) + 1e-300);
        ck_assert_near((double)af[k], rounded,
                       3e-7 * (fabs(rounded) + fabs((double)zf[k] * rounded)) + 1e-35);
      }
    }
  }
}
END_TEST

// One network by every kernel: V, ∇V, tangents, second derivatives and the parameter gradient of a Sobolev
// loss.
typedef struct Results {
  float y[64], gx[64 * 24], yt[2 * 64], second[4 * 64], gradient[80000];
} Results;

static void evaluate(const NetShape *shape, NetKernelKind kind, Results *out) {
  enum { COUNT = 32, TANGENTS = 2 };
  NetModel_f32 model;
  NetWork_f32 work;
  ck_net_ok(net_model_create_f32(shape, &model));
  net_model_initialise_f32(&model, 3);
  NetWorkDef def = {.thread_count = 1, .tangent_count = TANGENTS, .batch = COUNT, .kernel = kind};
  ck_net_ok(net_work_create_f32(model.plan, &def, &work));
  NetRandom random = net_random_seeded(14, 0);
  float x[COUNT * 24], xt[COUNT * TANGENTS * 24], c[COUNT * 2], g[COUNT * 2], gt[COUNT * TANGENTS * 2];
  float yt[COUNT * TANGENTS * 2];
  for (int k = 0; k < COUNT * 24; k++) x[k] = (float)net_random_between(&random, -1, 1);
  for (int k = 0; k < COUNT * TANGENTS * 24; k++) xt[k] = (float)net_random_between(&random, -1, 1);
  for (int k = 0; k < COUNT * 2; k++) c[k] = 1, g[k] = (float)net_random_between(&random, -1, 1);
  for (int k = 0; k < COUNT * TANGENTS * 2; k++) gt[k] = (float)net_random_between(&random, -1, 1);
  net_forward_gradient_f32(&work, &model, COUNT, x, c, out->y, out->gx);
  net_tangent_second_f32(&work, &model, COUNT, TANGENTS, x, xt, c, NULL, yt, NULL, out->second);
  memcpy(out->yt, yt, sizeof yt);
  net_gradient_forward_f32(&work, &model, COUNT, TANGENTS, x, xt, out->y, yt);
  net_gradient_backward_f32(&work, &model, COUNT, TANGENTS, g, gt, out->gradient);
  net_work_destroy_f32(&work);
  net_model_destroy_f32(&model);
}

static void check_near(int count, const float *a, const float *b) {
  double scale = 1e-3;
  for (int k = 0; k < count; k++) scale = fmax(scale, fabs((double)a[k]));
  for (int k = 0; k < count; k++) ck_assert_near((double)a[k], (double)b[k], 2e-5 * scale);
}

START_TEST(all_kernels_agree_on_a_whole_network) {
  NetShape shape = net_shape_tpn_b();
  shape.activation = NET_SILU; // no kinks, at which roundings could choose another side
  shape.pool = NET_SUM;
  Results *base = net_memory_zeroed(1, sizeof *base), *other = net_memory_zeroed(1, sizeof *other);
  evaluate(&shape, NET_KERNEL_BLAS, base);
  for (int kind = 1; kind < NET_KERNEL_COUNT; kind++) {
    if (!net_kernel_is_available((NetKernelKind)kind) || kind == NET_KERNEL_BF16) continue;
    evaluate(&shape, (NetKernelKind)kind, other);
    check_near(64, base->y, other->y);
    check_near(32 * 24, base->gx, other->gx);
    check_near(128, base->yt, other->yt);
    check_near(128, base->second, other->second);
    check_near(73370, base->gradient, other->gradient);
  }
  net_memory_free(base), net_memory_free(other);
}
END_TEST

START_TEST(a_work_that_cannot_be_is_refused) {
  NetShape shape = net_shape_mlp(3, 4, 1, 1);
  NetModel_f32 model;
  NetWork_f32 work;
  ck_net_ok(net_model_create_f32(&shape, &model));
  NetWorkDef def = net_work_default();
  def.thread_count = 0;
  ck_net_fails(net_work_create_f32(model.plan, &def, &work), NET_BAD_ARGUMENT, "0 threads");
  def = net_work_default();
  def.tangent_count = -1;
  ck_net_fails(net_work_create_f32(model.plan, &def, &work), NET_BAD_ARGUMENT, "tangents");
  def = net_work_default();
  def.kernel = NET_KERNEL_COUNT;
  ck_net_fails(net_work_create_f32(model.plan, &def, &work), NET_BAD_ARGUMENT, "kernel");
  net_model_destroy_f32(&model);
}
END_TEST

START_TEST(every_allocation_may_fail) {
  NetShape shape = net_shape_mlp(3, 4, 1, 1);
  for (long k = 1; k <= 6; k++) {
    NetModel_f32 model = {0};
    NetWork_f32 work = {0};
    NetWorkDef def = net_work_default();
    net_memory_fail_at(k);
    NetStatus status = net_model_create_f32(&shape, &model);
    if (status == NET_OK) status = net_work_create_f32(model.plan, &def, &work);
    net_memory_fail_at(0);
    ck_assert_int_eq(status, NET_NO_MEMORY);
    ck_assert_ptr_nonnull(strstr(net_status_message(), "no memory for"));
    net_work_destroy_f32(&work);
    net_model_destroy_f32(&model);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_kernel");
  tcase_add_test(test_case, products_are_what_their_definition_says);
  tcase_add_test(test_case, outer_products_and_row_sums_are_added);
  tcase_add_test(test_case, silu_agrees_with_the_c_library);
  tcase_add_test(test_case, all_kernels_agree_on_a_whole_network);
  tcase_add_test(test_case, a_work_that_cannot_be_is_refused);
  tcase_add_test(test_case, every_allocation_may_fail);
  return suite_run("net_kernel", test_case, 60);
}
