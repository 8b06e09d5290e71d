// SPDX-License-Identifier: GPL-3.0-or-later
// net/: every derivative against central differences, in double, over networks of random shape.
//
// A ReLU or max has kinks. A difference that straddles one says nothing; it is recognised by differences of
// two step lengths that disagree, left out, and counted: few may be.
#include "net_suite.h"

enum { SHAPES = 30, SAMPLES = 5, TANGENTS = 3 };

typedef struct Tally {
  int compared, kinks;
} Tally;

// One derivative against differences with steps h and h/2, relative to `scale`.
static void compare(Tally *tally, double derivative, double coarse, double fine, double scale) {
  if (fabs(coarse - fine) > 1e-6 * scale) {
    tally->kinks++;
    return;
  }
  tally->compared++;
  ck_assert_near(derivative, fine, 2e-7 * scale);
}

static void check_tally(const Tally *tally) {
  ck_assert_int_gt(tally->compared, 100);
  ck_assert_msg(tally->kinks * 20 < tally->compared, "%d kinks in %d", tally->kinks, tally->compared);
}

static double largest(int count, const double *x) {
  double result = 1e-3;
  for (int k = 0; k < count; k++) result = fmax(result, fabs(x[k]));
  return result;
}

// A network with random inputs, directions and weights of outputs.
typedef struct Case {
  NetModel_f64 model;
  NetWork_f64 work;
  int inputs, outputs;
  double *x, *xt, *c, *ct, *y, *yt;
} Case;

static Case make_case(int index, NetKind kind, int only_activation) {
  NetRandom random = net_random_seeded(77, (uint64_t)(2 * index + (kind == NET_MLP)));
  NetShape shape = net_suite_shape(&random, kind);
  if (only_activation >= 0) shape.activation = (NetActivation)only_activation;
  Case made = {.inputs = shape.input_count, .outputs = shape.output_count};
  made.model = net_suite_model(&shape, (uint64_t)index);
  made.work = net_suite_work(&made.model, 1, 32, SAMPLES);
  made.x = net_suite_array(&random, SAMPLES * made.inputs, 1);
  made.xt = net_suite_array(&random, SAMPLES * TANGENTS * made.inputs, 1);
  made.c = net_suite_array(&random, SAMPLES * made.outputs, 1);
  made.ct = net_suite_array(&random, SAMPLES * TANGENTS * made.outputs, 1);
  made.y = net_suite_array(&random, SAMPLES * made.outputs, 0);
  made.yt = net_suite_array(&random, SAMPLES * TANGENTS * made.outputs, 0);
  return made;
}

static void destroy_case(Case *used) {
  net_work_destroy_f64(&used->work);
  net_model_destroy_f64(&used->model);
  double *arrays[] = {used->x, used->xt, used->c, used->ct, used->y, used->yt};
  for (int k = 0; k < 6; k++) net_memory_free(arrays[k]);
}

static double dot(int count, const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < count; k++) sum += a[k] * b[k];
  return sum;
}

// c · y of sample s at x + h along direction d.
static double combination_at(Case *used, int s, const double *d, double h) {
  double x[64], y[8];
  for (int i = 0; i < used->inputs; i++) x[i] = used->x[s * used->inputs + i] + h * d[i];
  net_forward_eval_f64(&used->work, &used->model, 1, x, y);
  return dot(used->outputs, used->c + s * used->outputs, y);
}

static double difference(Case *used, int s, const double *d, double h) {
  return (combination_at(used, s, d, h) - combination_at(used, s, d, -h)) / (2 * h);
}

static void check_input_gradient(Case *used, Tally *tally) {
  double *gx = net_memory_zeroed((size_t)(SAMPLES * used->inputs), sizeof *gx);
  net_forward_gradient_f64(&used->work, &used->model, SAMPLES, used->x, used->c, used->y, gx);
  double scale = largest(SAMPLES * used->inputs, gx);
  for (int s = 0; s < SAMPLES; s++)
    for (int i = 0; i < used->inputs; i++) {
      double unit[64] = {0};
      unit[i] = 1;
      compare(tally, gx[s * used->inputs + i], difference(used, s, unit, 2e-5),
              difference(used, s, unit, 1e-5), scale);
    }
  net_memory_free(gx);
}

START_TEST(the_input_gradient_is_the_derivative_of_any_combination_of_outputs) {
  Tally tally = {0};
  for (int k = 0; k < SHAPES; k++)
    for (int kind = 0; kind < 2; kind++) {
      Case used = make_case(k, (NetKind)kind, -1);
      check_input_gradient(&used, &tally);
      destroy_case(&used);
    }
  check_tally(&tally);
}
END_TEST

START_TEST(tangents_are_the_input_gradients_times_the_directions) {
  for (int k = 0; k < SHAPES; k++)
    for (int kind = 0; kind < 2; kind++) {
      Case used = make_case(k, (NetKind)kind, -1);
      double *gx = net_memory_zeroed((size_t)(SAMPLES * used.inputs), sizeof *gx);
      double *plain = net_memory_zeroed((size_t)(SAMPLES * used.outputs), sizeof *plain);
      net_forward_gradient_f64(&used.work, &used.model, SAMPLES, used.x, used.c, plain, gx);
      net_tangent_eval_f64(&used.work, &used.model, SAMPLES, TANGENTS, used.x, used.xt, used.y, used.yt);
      for (int i = 0; i < SAMPLES * used.outputs; i++)
        ck_assert_near(used.y[i], plain[i], 1e-13 * (1 + fabs(plain[i])));
      for (int s = 0; s < SAMPLES; s++)
        for (int t = 0; t < TANGENTS; t++) {
          int at = s * TANGENTS + t;
          double forward = dot(used.outputs, used.c + s * used.outputs, used.yt + at * used.outputs);
          double backward = dot(used.inputs, gx + s * used.inputs, used.xt + at * used.inputs);
          ck_assert_near(forward, backward, 1e-12 * (1 + fabs(backward)));
        }
      net_memory_free(gx), net_memory_free(plain);
      destroy_case(&used);
    }
}
END_TEST

// Equal vertices and equal tetrahedra: every pool compares equals. Which of them wins must be the same
// forward and backward.
START_TEST(at_ties_of_a_maximum_tangents_and_gradients_follow_the_same_winner) {
  NetShape shape = net_shape_tpn_a();
  NetModel_f64 model = net_suite_model(&shape, 8);
  NetWork_f64 work = net_suite_work(&model, 1, 1, 0);
  NetRandom random = net_random_seeded(15, 0);
  double x[24], *xt = net_suite_array(&random, 24, 1), c[2] = {0.3, 1}, y[2], yt[2], gx[24];
  for (int k = 0; k < 24; k++) x[k] = k % 3 - 0.4;
  net_forward_gradient_f64(&work, &model, 1, x, c, y, gx);
  net_tangent_eval_f64(&work, &model, 1, 1, x, xt, y, yt);
  double forward = dot(2, c, yt), backward = dot(24, gx, xt);
  ck_assert_double_gt(fabs(forward), 1e-3);
  ck_assert_near(forward, backward, 1e-12 * (1 + fabs(forward)));
  net_memory_free(xt);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

START_TEST(every_evaluation_gives_the_same_bits_for_any_number_of_threads) {
  enum { MANY = 400, INPUTS = 12 };
  NetShape shape = net_shape_mlp(INPUTS, 9, 2, 1);
  NetModel_f64 model = net_suite_model(&shape, 8);
  NetRandom random = net_random_seeded(16, 0);
  double *x = net_suite_array(&random, MANY * INPUTS, 1),
         *xt = net_suite_array(&random, MANY * 2 * INPUTS, 1);
  double *c = net_suite_array(&random, MANY, 1);
  static double y[2][MANY], gx[2][MANY * INPUTS], yt[2][MANY * 2], dual[2][MANY * 2], second[2][MANY * 4];
  for (int run = 0; run < 2; run++) {
    NetWork_f64 work = net_suite_work(&model, 1 + 3 * run, 2, 0);
    net_forward_gradient_f64(&work, &model, MANY, x, c, NULL, gx[run]);
    net_tangent_eval_f64(&work, &model, MANY, 2, x, xt, NULL, yt[run]);
    net_tangent_second_f64(&work, &model, MANY, 2, x, xt, c, NULL, dual[run], NULL, second[run]);
    net_forward_eval_f64(&work, &model, MANY, x, y[run]);
    net_work_destroy_f64(&work);
  }
  ck_assert_int_eq(memcmp(y[0], y[1], sizeof y[0]), 0);
  ck_assert_int_eq(memcmp(gx[0], gx[1], sizeof gx[0]), 0);
  ck_assert_int_eq(memcmp(yt[0], yt[1], sizeof yt[0]), 0);
  ck_assert_int_eq(memcmp(dual[0], dual[1], sizeof dual[0]), 0);
  ck_assert_int_eq(memcmp(second[0], second[1], sizeof second[0]), 0);
  ck_assert_double_ne(second[0][4 * MANY - 1], 0);
  net_memory_free(x), net_memory_free(xt), net_memory_free(c);
  net_model_destroy_f64(&model);
}
END_TEST

// L = Σ c y + ½ y² + c_t yt + ½ yt², a loss in which values and tangents are bent.
static double loss_of(Case *used, int tangents, double *gy, double *gyt) {
  int n = SAMPLES * used->outputs, m = n * tangents;
  net_gradient_forward_f64(&used->work, &used->model, SAMPLES, tangents, used->x, tangents ? used->xt : NULL,
                           used->y, tangents ? used->yt : NULL);
  double loss = 0;
  for (int k = 0; k < n; k++) {
    loss += (used->c[k] + 0.5 * used->y[k]) * used->y[k];
    if (gy) gy[k] = used->c[k] + used->y[k];
  }
  for (int k = 0; k < m; k++) {
    loss += (used->ct[k] + 0.5 * used->yt[k]) * used->yt[k];
    if (gyt) gyt[k] = used->ct[k] + used->yt[k];
  }
  return loss;
}

static double loss_difference(Case *used, int tangents, double *parameter, double h) {
  double kept = *parameter;
  *parameter = kept + h;
  double above = loss_of(used, tangents, NULL, NULL);
  *parameter = kept - h;
  double below = loss_of(used, tangents, NULL, NULL);
  *parameter = kept;
  return (above - below) / (2 * h);
}

static void check_parameter_gradient(Case *used, int tangents, Tally *tally, NetRandom *random) {
  int count = (int)used->model.plan->parameter_count, n = SAMPLES * used->outputs;
  double *gradient = net_memory_zeroed((size_t)count, sizeof *gradient);
  double *gy = net_memory_zeroed((size_t)n, sizeof *gy),
         *gyt = net_memory_zeroed((size_t)(n * TANGENTS), sizeof *gyt);
  loss_of(used, tangents, gy, gyt);
  net_gradient_backward_f64(&used->work, &used->model, SAMPLES, tangents, gy, tangents ? gyt : NULL,
                            gradient);
  double scale = largest(count, gradient);
  // Two of every tensor, so that none is left out.
  for (int k = 0; k < used->model.plan->tensor_count; k++)
    for (int draw = 0; draw < 2; draw++) {
      const NetTensor *tensor = &used->model.plan->tensors[k];
      int at = (int)tensor->offset + net_suite_below(random, (int)net_plan_tensor_size(tensor));
      double *parameter = used->model.parameters + at;
      compare(tally, gradient[at], loss_difference(used, tangents, parameter, 2e-5),
              loss_difference(used, tangents, parameter, 1e-5), scale);
    }
  net_memory_free(gradient), net_memory_free(gy), net_memory_free(gyt);
}

START_TEST(the_parameter_gradient_is_the_derivative_of_a_loss_of_values) {
  Tally tally = {0};
  NetRandom random = net_random_seeded(5, 0);
  for (int k = 0; k < SHAPES; k++)
    for (int kind = 0; kind < 2; kind++) {
      Case used = make_case(k, (NetKind)kind, -1);
      check_parameter_gradient(&used, 0, &tally, &random);
      destroy_case(&used);
    }
  check_tally(&tally);
}
END_TEST

START_TEST(the_parameter_gradient_is_the_derivative_of_a_loss_that_contains_tangents) {
  Tally tally = {0};
  NetRandom random = net_random_seeded(6, 0);
  for (int k = 0; k < SHAPES; k++)
    for (int kind = 0; kind < 2; kind++) {
      Case used = make_case(k, (NetKind)kind, -1);
      check_parameter_gradient(&used, TANGENTS, &tally, &random);
      destroy_case(&used);
    }
  check_tally(&tally);
}
END_TEST

// d/dh of the tangent along t at x + h u.
static double second_difference(Case *used, int s, const double *t, const double *u, double h) {
  double x[64], y[8], above[8], below[8];
  for (int side = -1; side <= 1; side += 2) {
    for (int i = 0; i < used->inputs; i++) x[i] = used->x[s * used->inputs + i] + side * h * u[i];
    net_tangent_eval_f64(&used->work, &used->model, 1, 1, x, t, y, side < 0 ? below : above);
  }
  const double *c = used->c + s * used->outputs;
  return (dot(used->outputs, c, above) - dot(used->outputs, c, below)) / (2 * h);
}

START_TEST(second_derivatives_are_derivatives_of_tangents_and_symmetric) {
  Tally tally = {0};
  for (int k = 0; k < SHAPES; k++)
    for (int kind = 0; kind < 2; kind++) {
      Case used = make_case(k, (NetKind)kind, NET_SILU);
      double second[SAMPLES * TANGENTS * TANGENTS];
      double *gx = net_memory_zeroed((size_t)(SAMPLES * used.inputs), sizeof *gx);
      double *again = net_memory_zeroed((size_t)(SAMPLES * used.inputs), sizeof *gx);
      net_tangent_second_f64(&used.work, &used.model, SAMPLES, TANGENTS, used.x, used.xt, used.c, used.y,
                             used.yt, gx, second);
      net_forward_gradient_f64(&used.work, &used.model, SAMPLES, used.x, used.c, NULL, again);
      for (int i = 0; i < SAMPLES * used.inputs; i++)
        ck_assert_near(gx[i], again[i], 1e-12 * (1 + fabs(again[i])));
      double scale = largest(SAMPLES * TANGENTS * TANGENTS, second);
      for (int s = 0; s < SAMPLES; s++)
        for (int t = 0; t < TANGENTS; t++)
          for (int u = 0; u < TANGENTS; u++) {
            const double *dt = used.xt + (s * TANGENTS + t) * used.inputs;
            const double *du = used.xt + (s * TANGENTS + u) * used.inputs;
            double value = second[(s * TANGENTS + t) * TANGENTS + u];
            ck_assert_double_eq(value, second[(s * TANGENTS + u) * TANGENTS + t]);
            compare(&tally, value, second_difference(&used, s, dt, du, 2e-5),
                    second_difference(&used, s, dt, du, 1e-5), scale);
          }
      net_memory_free(gx), net_memory_free(again);
      destroy_case(&used);
    }
  check_tally(&tally);
}
END_TEST

START_TEST(the_hessian_of_a_rectified_network_is_zero) {
  Case used = make_case(3, NET_TPN, NET_RELU);
  double second[SAMPLES * TANGENTS * TANGENTS];
  net_tangent_second_f64(&used.work, &used.model, SAMPLES, TANGENTS, used.x, used.xt, used.c, NULL, NULL,
                         NULL, second);
  for (int k = 0; k < SAMPLES * TANGENTS * TANGENTS; k++) ck_assert_double_eq(second[k], 0);
  destroy_case(&used);
}
END_TEST

// f = SiLU(w x), one input: f′ = w σ(1 + z (1 − σ)), f″ = w² σ(1 − σ)(2 + z (1 − 2σ)) at z = 0: w/2 and w²/2.
START_TEST(one_silu_has_the_derivatives_that_a_hand_computes) {
  NetShape shape = net_shape_mlp(1, 1, 1, 1);
  NetModel_f64 model;
  ck_net_ok(net_model_create_f64(&shape, &model));
  *net_model_tensor_f64(&model, "layer.0.weight") = 3;
  *net_model_tensor_f64(&model, "layer.1.weight") = 1;
  NetWork_f64 work = net_suite_work(&model, 1, 1, 0);
  double x = 0, xt = 1, c = 1, y, yt, gx, second;
  net_tangent_second_f64(&work, &model, 1, 1, &x, &xt, &c, &y, &yt, &gx, &second);
  ck_assert_near(y, 0, 1e-15);
  ck_assert_near(yt, 1.5, 1e-14);
  ck_assert_near(gx, 1.5, 1e-14);
  ck_assert_near(second, 4.5, 1e-13);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

// What is not asked for is not computed, and what is asked for is the same to the bit.
START_TEST(an_output_alone_is_what_it_is_among_all) {
  for (int index = 0; index < SHAPES; index++) {
    Case all = make_case(index, NET_TPN, -1);
    double y[SAMPLES * 2], gx[SAMPLES * 24], alone[SAMPLES * 24];
    for (int wanted = 0; wanted < 2; wanted++) {
      for (int k = 0; k < SAMPLES * 2; k++) all.c[k] = k % 2 == wanted;
      all.work.outputs = UINT64_MAX;
      net_forward_gradient_f64(&all.work, &all.model, SAMPLES, all.x, all.c, all.y, gx);
      all.work.outputs = (uint64_t)1 << wanted;
      net_forward_gradient_f64(&all.work, &all.model, SAMPLES, all.x, all.c, y, alone);
      ck_assert_mem_eq(gx, alone, sizeof gx);
      for (int k = 0; k < SAMPLES * 2; k++) ck_assert(y[k] == (k % 2 == wanted ? all.y[k] : 0));
    }
    destroy_case(&all);
  }
}
END_TEST

// A dense network on columns against the same on rows, by every kernel.
START_TEST(a_dense_network_takes_columns) {
  NetShape shape = net_shape_mlp(36, 19, 2, 1);
  ck_assert(net_dense_is_possible(&shape));
  NetModel_f64 model = net_suite_model(&shape, 5);
  for (int kind = 0; kind < NET_KERNEL_COUNT; kind++) {
    if (!net_kernel_f64((NetKernelKind)kind)) continue;
    NetWork_f64 work;
    NetWorkDef def = net_work_default();
    def.kernel = (NetKernelKind)kind;
    ck_net_ok(net_work_create_f64(model.plan, &def, &work));
    NetRandom random = net_random_seeded(15, 0);
    enum { COUNT = NET_COLUMN_UNIT, INPUTS = 36 };
    double *x = net_suite_array(&random, COUNT * INPUTS, 2),
           *rows = net_suite_array(&random, COUNT * INPUTS, 0);
    double *gx = net_suite_array(&random, COUNT * INPUTS, 0), by_rows[COUNT * INPUTS], ones[COUNT];
    _Alignas(64) double y[COUNT];
    double *columns = net_suite_array(&random, COUNT, 0);
    for (int j = 0; j < COUNT; j++) {
      ones[j] = 1;
      for (int f = 0; f < INPUTS; f++) rows[j * INPUTS + f] = x[f * COUNT + j];
    }
    net_forward_gradient_f64(&work, &model, COUNT, rows, ones, y, by_rows);
    net_dense_eval_f64(&work, &model, 1, x, columns, gx);
    for (int j = 0; j < COUNT; j++) {
      ck_assert_near(columns[j], y[j], 1e-14 * (1 + fabs(y[j])));
      for (int f = 0; f < INPUTS; f++) ck_assert_near(gx[f * COUNT + j], by_rows[j * INPUTS + f], 1e-14);
    }
    net_dense_eval_f64(&work, &model, 1, x, y, NULL);
    ck_assert_mem_eq(y, columns, sizeof y);
    net_memory_free(x), net_memory_free(rows), net_memory_free(gx), net_memory_free(columns);
    net_work_destroy_f64(&work);
  }
  net_model_destroy_f64(&model);
}
END_TEST

// Second derivatives on columns against those on rows.
START_TEST(a_dense_network_bends_columns) {
  enum { COUNT = NET_COLUMN_UNIT, INPUTS = 9, WAYS = 5, PAIRS = WAYS * (WAYS + 1) / 2 };
  NetShape shape = net_shape_mlp(INPUTS, 19, 3, 1);
  NetModel_f64 model = net_suite_model(&shape, 6);
  for (int kind = 0; kind < NET_KERNEL_COUNT; kind++) {
    if (!net_kernel_f64((NetKernelKind)kind)) continue;
    NetWork_f64 work;
    NetWorkDef def = net_work_default();
    def.kernel = (NetKernelKind)kind;
    def.tangent_count = WAYS;
    ck_net_ok(net_work_create_f64(model.plan, &def, &work));
    NetRandom random = net_random_seeded(16, 0);
    double *columns = net_suite_array(&random, INPUTS * (1 + WAYS) * COUNT, 1);
    double *second = net_suite_array(&random, PAIRS * COUNT, 1);
    double x[COUNT * INPUTS], xt[COUNT * WAYS * INPUTS], ones[COUNT], whole[COUNT * WAYS * WAYS];
    for (int j = 0; j < COUNT; j++) {
      ones[j] = 1;
      for (int f = 0; f < INPUTS; f++) {
        const double *row = columns + f * (1 + WAYS) * COUNT + j;
        x[j * INPUTS + f] = row[0];
        for (int t = 0; t < WAYS; t++) xt[(j * WAYS + t) * INPUTS + f] = row[(1 + t) * COUNT];
      }
    }
    net_tangent_second_f64(&work, &model, COUNT, WAYS, x, xt, ones, NULL, NULL, NULL, whole);
    net_dense_second_f64(&work, &model, WAYS, columns, second);
    for (int j = 0; j < COUNT; j++)
      for (int t = 0, pair = 0; t < WAYS; t++)
        for (int u = 0; u <= t; u++, pair++)
          ck_assert_near(second[pair * COUNT + j], whole[(j * WAYS + t) * WAYS + u], 1e-13);
    net_memory_free(columns), net_memory_free(second);
    net_work_destroy_f64(&work);
  }
  net_model_destroy_f64(&model);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_derivatives");
  tcase_add_test(test_case, one_silu_has_the_derivatives_that_a_hand_computes);
  tcase_add_test(test_case, the_input_gradient_is_the_derivative_of_any_combination_of_outputs);
  tcase_add_test(test_case, tangents_are_the_input_gradients_times_the_directions);
  tcase_add_test(test_case, at_ties_of_a_maximum_tangents_and_gradients_follow_the_same_winner);
  tcase_add_test(test_case, every_evaluation_gives_the_same_bits_for_any_number_of_threads);
  tcase_add_test(test_case, the_parameter_gradient_is_the_derivative_of_a_loss_of_values);
  tcase_add_test(test_case, the_parameter_gradient_is_the_derivative_of_a_loss_that_contains_tangents);
  tcase_add_test(test_case, second_derivatives_are_derivatives_of_tangents_and_symmetric);
  tcase_add_test(test_case, the_hessian_of_a_rectified_network_is_zero);
  tcase_add_test(test_case, an_output_alone_is_what_it_is_among_all);
  tcase_add_test(test_case, a_dense_network_takes_columns);
  tcase_add_test(test_case, a_dense_network_bends_columns);
  return suite_run("net_derivatives", test_case, 60);
}
