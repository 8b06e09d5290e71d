// SPDX-License-Identifier: GPL-3.0-or-later
// net/: parameter counts of the paper's readings, shapes as text, and what a shape is and is not invariant
// to.
#include "net_suite.h"

static size_t count_of(NetShape shape) {
  NetPlan *plan = net_memory_zeroed(1, sizeof *plan);
  ck_net_ok(net_plan_create(&shape, plan));
  size_t count = plan->parameter_count, sum = 0;
  for (int k = 0; k < plan->tensor_count; k++) sum += net_plan_tensor_size(&plan->tensors[k]);
  ck_assert_uint_eq(sum, count);
  net_memory_free(plan);
  return count;
}

START_TEST(all_readings_of_the_paper_have_73370_parameters) {
  ck_assert_uint_eq(count_of(net_shape_tpn_a()), 73370);
  ck_assert_uint_eq(count_of(net_shape_tpn_b()), 73370);
  ck_assert_uint_eq(count_of(net_shape_tpn_c()), 73370);
}
END_TEST

// Rows × columns of the published network's tensors, off its authors' code; a bias has one column.
START_TEST(the_published_network_has_its_tensors) {
  static const struct {
    const char *name;
    int rows, columns;
  } expected[] = {
      {"vertex.0", 24, 3},
      {"vertex.1", 24, 24},
      {"vertex_skip.0", 24, 3},
      {"vertex_skip.7", 24, 3},
      {"tetrahedron.0", 48, 24},
      {"tetrahedron.1", 48, 48},
      {"tetrahedron_skip.0", 48, 12},
      {"tetrahedron_skip.1", 48, 12},
      {"combiner.0", 96, 48},
      {"combiner.1", 96, 96},
      {"combiner_skip", 96, 12},
      {"status_head.0", 128, 96},
      {"status_head.1", 64, 128},
      {"status_head.2", 32, 64},
      {"status_head.3", 1, 32},
      {"volume_head.0", 128, 96},
      {"volume_head.1", 128, 128},
      {"volume_head.2", 1, 128},
  };
  NetShape shape = net_shape_tpn_c();
  NetPlan *plan = net_memory_zeroed(1, sizeof *plan);
  ck_net_ok(net_plan_create(&shape, plan));
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
    char name[NET_NAME_SIZE];
    snprintf(name, sizeof name, "%s.weight", expected[k].name);
    int weight = net_plan_find(plan, name);
    snprintf(name, sizeof name, "%s.bias", expected[k].name);
    int bias = net_plan_find(plan, name);
    ck_assert_msg(weight >= 0 && bias >= 0, "%s", expected[k].name);
    ck_assert_int_eq(plan->tensors[weight].rows, expected[k].rows);
    ck_assert_int_eq(plan->tensors[weight].columns, expected[k].columns);
    ck_assert_int_eq(plan->tensors[bias].rows, expected[k].rows);
  }
  ck_assert_int_eq(plan->tensor_count, 2 * (18 + 6)); // six vertex skips are not named above
  net_memory_free(plan);
}
END_TEST

// What no input reaches has no gradient: four vertex skips, 4 (24 · 3 + 24), and a tetrahedron's, 48 · 12
// + 48.
START_TEST(the_published_network_never_reaches_1008_parameters) {
  NetShape shape = net_shape_tpn_c();
  NetModel_f64 model = net_suite_model(&shape, 6);
  NetWork_f64 work = net_suite_work(&model, 1, 0, 64);
  NetRandom random = net_random_seeded(7, 0);
  size_t count = model.plan->parameter_count, idle = 0, others = 0;
  double *x = net_suite_array(&random, 64 * 12, 2), *gy = net_suite_array(&random, 64 * 2, 1), y[128];
  double *gradient = net_suite_array(&random, (int)count, 1);
  net_gradient_forward_f64(&work, &model, 64, 0, x, NULL, y, NULL);
  net_gradient_backward_f64(&work, &model, 64, 0, gy, NULL, gradient);
  for (int k = 0; k < model.plan->tensor_count; k++) {
    const NetTensor *tensor = &model.plan->tensors[k];
    double largest = 0;
    for (size_t i = 0; i < net_plan_tensor_size(tensor); i++)
      largest = suite_larger(largest, fabs(gradient[tensor->offset + i]));
    if (strstr(tensor->name, "_skip.") && largest == 0)
      idle += net_plan_tensor_size(tensor);
    else
      others += largest > 0 ? net_plan_tensor_size(tensor) : 0;
  }
  ck_assert_uint_eq(idle, 1008);
  ck_assert_uint_eq(others, 73370 - 1008);
  net_memory_free(x), net_memory_free(gy), net_memory_free(gradient);
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

// 73,370 − heads' first layers from 96 (2 · 97 · 128) + 97 · 1024 + 2 · 1025 · 128.
START_TEST(the_1024_backbone_has_410266_parameters) {
  ck_assert_uint_eq(count_of(net_shape_tpn_backbone()), 73370 - 2 * 97 * 128 + 97 * 1024 + 2 * 1025 * 128);
}
END_TEST

// (36 + 1) 16 + (16 + 1) 16 + (16 + 1), and (100 + 1) 32 + 2 (32 + 1) 32 + 33.
START_TEST(the_networks_of_the_study_have_their_parameters) {
  ck_assert_uint_eq(count_of(net_shape_mlp(36, 16, 2, 1)), 881);
  ck_assert_uint_eq(count_of(net_shape_mlp(100, 32, 3, 1)), 5377);
}
END_TEST

START_TEST(a_shape_survives_its_text) {
  NetRandom random = net_random_seeded(1, 0);
  for (int k = 0; k < 200; k++) {
    NetShape shape = net_suite_shape(&random, (NetKind)(k % 2)), back;
    char text[NET_SHAPE_TEXT];
    ck_net_ok(net_shape_print(&shape, text));
    ck_net_ok(net_shape_parse(text, &back));
    ck_assert_msg(net_shape_equal(&shape, &back), "%s", text);
  }
}
END_TEST

START_TEST(a_wrong_shape_text_is_refused_by_the_key) {
  NetShape shape;
  ck_net_fails(net_shape_parse("{", &shape), NET_BAD_FILE, "line 1");
  ck_net_fails(net_shape_parse("{\"kind\":\"cnn\"}", &shape), NET_BAD_FILE, "\"kind\"");
  ck_net_fails(net_shape_parse("{\"kind\":\"mlp\"}", &shape), NET_BAD_FILE, "\"activation\" is missing");
  const char *hidden[] = {"7", "[0]", "[1,2,3,4,5,6,7,8,9]", "[1.5]", "[\"8\"]", "[1000000]"};
  for (int k = 0; k < 6; k++) {
    char text[200];
    snprintf(text, sizeof text,
             "{\"kind\":\"mlp\",\"activation\":\"silu\",\"inputs\":3,\"hidden\":%s,\"outputs\":1}",
             hidden[k]);
    ck_net_fails(net_shape_parse(text, &shape), NET_BAD_FILE, "\"hidden\"");
  }
  ck_net_fails(
      net_shape_parse("{\"kind\":\"mlp\",\"activation\":\"silu\",\"inputs\":3,\"hidden\":[],\"outputs\":0}",
                      &shape),
      NET_BAD_FILE, "0 outputs");
  ck_net_fails(
      net_shape_parse("{\"kind\":\"mlp\",\"activation\":\"silu\",\"inputs\":3,\"hidden\":[],\"outputs\":1,"
                      "\"dropout\":1}",
                      &shape),
      NET_BAD_FILE, "1 unknown");
}
END_TEST

START_TEST(a_shape_out_of_range_is_refused_by_the_field) {
  NetModel_f32 model;
  NetShape shape = net_shape_tpn_a();
  shape.vertex.count = 0;
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "vertex has 0 layers");
  shape = net_shape_tpn_a();
  shape.volume_head.width[1] = -3;
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "volume_head");
  shape = net_shape_tpn_a();
  shape.combiner_skip = NET_SKIP_PER_INDEX;
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "per_index");
  shape.combiner_skip = NET_SKIP_OWN;
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "own");
  shape = net_shape_tpn_c();
  shape.input_count = 24;
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "12 inputs");
  shape = net_shape_mlp(5, 8, 9, 1);
  ck_net_fails(net_model_create_f32(&shape, &model), NET_BAD_ARGUMENT, "hidden has 9 layers");
}
END_TEST

// Outputs of a deepest shape of every block: the plan's fixed tables hold it.
START_TEST(the_deepest_shape_can_be_evaluated) {
  NetShape shape = net_shape_tpn_b();
  NetWidths deepest = {NET_MAX_DEPTH, {3, 3, 3, 3, 3, 3, 3, 3}};
  shape.vertex = shape.tetrahedron = shape.combiner = deepest;
  shape.backbone = shape.status_head = shape.volume_head = deepest;
  shape.activation = NET_SILU;
  shape.vertex_skip = shape.tetrahedron_skip = NET_SKIP_OWN;
  shape.combiner_skip = NET_SKIP_BIASED;
  NetModel_f64 model = net_suite_model(&shape, 1);
  NetWork_f64 work = net_suite_work(&model, 1, 0, 0);
  double x[24] = {0.5}, y[2];
  net_forward_eval_f64(&work, &model, 1, x, y);
  ck_assert(isfinite(y[0]) && isfinite(y[1]));
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
}
END_TEST

// The largest change of the outputs when the vertices of the first tetrahedron are reordered, or the
// tetrahedra swapped.
static double defect(NetShape shape, bool is_swap) {
  NetModel_f64 model = net_suite_model(&shape, 4);
  NetWork_f64 work = net_suite_work(&model, 1, 0, 0);
  NetRandom random = net_random_seeded(9, 0);
  double worst = 0;
  for (int draw = 0; draw < 20; draw++) {
    double *x = net_suite_array(&random, 24, 1), z[24], y[2], w[2];
    static const int order[4] = {2, 0, 3, 1};
    memcpy(z, x, sizeof z);
    if (is_swap)
      memcpy(z, x + 12, 12 * sizeof *z), memcpy(z + 12, x, 12 * sizeof *z);
    else
      for (int a = 0; a < 4; a++) memcpy(z + 3 * a, x + 3 * order[a], 3 * sizeof *z);
    net_forward_eval_f64(&work, &model, 1, x, y);
    net_forward_eval_f64(&work, &model, 1, z, w);
    for (int k = 0; k < 2; k++) worst = suite_larger(worst, fabs(y[k] - w[k]) / (1 + fabs(y[k])));
    net_memory_free(x);
  }
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&model);
  return worst;
}

START_TEST(without_raw_skips_the_order_of_vertices_and_tetrahedra_does_not_matter) {
  for (int pool = 0; pool < 2; pool++)
    for (int activation = 0; activation < 2; activation++) {
      NetShape shape = net_shape_tpn_a();
      shape.pool = (NetPool)pool, shape.activation = (NetActivation)activation;
      shape.tetrahedron_skip = shape.combiner_skip = NET_SKIP_NONE;
      ck_assert_double_le(defect(shape, false), 1e-13);
      ck_assert_double_le(defect(shape, true), 1e-13);
    }
}
END_TEST

// The paper says that its network is invariant. Its residuals of raw coordinates are not.
START_TEST(each_raw_skip_of_the_paper_breaks_an_invariance) {
  NetShape twelve = net_shape_tpn_a();
  twelve.combiner_skip = NET_SKIP_NONE;
  ck_assert_double_gt(defect(twelve, false), 1e-3);
  ck_assert_double_le(defect(twelve, true), 1e-13); // the two tetrahedra are still treated alike

  NetShape twenty_four = net_shape_tpn_a();
  twenty_four.tetrahedron_skip = NET_SKIP_NONE;
  ck_assert_double_gt(defect(twenty_four, false), 1e-3);
  ck_assert_double_gt(defect(twenty_four, true), 1e-3);

  NetShape per_index = net_shape_tpn_b();
  per_index.tetrahedron_skip = per_index.combiner_skip = NET_SKIP_NONE;
  ck_assert_double_gt(defect(per_index, false), 1e-3);
  ck_assert_double_le(defect(per_index, true), 1e-13);
}
END_TEST

START_TEST(initial_weights_are_a_function_of_the_seed_and_within_their_bounds) {
  NetShape shape = net_shape_tpn_a();
  NetModel_f32 a, b, c;
  ck_net_ok(net_model_create_f32(&shape, &a));
  ck_net_ok(net_model_create_f32(&shape, &b));
  ck_net_ok(net_model_create_f32(&shape, &c));
  net_model_initialise_f32(&a, 7), net_model_initialise_f32(&b, 7), net_model_initialise_f32(&c, 8);
  ck_assert_int_eq(memcmp(a.parameters, b.parameters, 73370 * sizeof *a.parameters), 0);
  ck_assert_int_ne(memcmp(a.parameters, c.parameters, 73370 * sizeof *a.parameters), 0);
  // 96 → 96 before a rectifier: uniform in ±√(6/96), variance 2/96.
  const float *weight = net_model_tensor_f32(&a, "combiner.1.weight");
  double squares = 0;
  for (int k = 0; k < 96 * 96; k++) {
    ck_assert_double_le(fabs((double)weight[k]), 0.25 + 1e-7);
    squares += (double)(weight[k] * weight[k]);
  }
  ck_assert_near(squares / (96 * 96), 2.0 / 96, 0.05 * 2 / 96);
  ck_assert_float_eq(net_model_tensor_f32(&a, "combiner.1.bias")[5], 0);
  ck_assert_ptr_null(net_model_tensor_f32(&a, "combiner.9.bias"));
  net_model_destroy_f32(&a), net_model_destroy_f32(&b), net_model_destroy_f32(&c);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_shape");
  tcase_add_test(test_case, all_readings_of_the_paper_have_73370_parameters);
  tcase_add_test(test_case, the_published_network_has_its_tensors);
  tcase_add_test(test_case, the_published_network_never_reaches_1008_parameters);
  tcase_add_test(test_case, the_1024_backbone_has_410266_parameters);
  tcase_add_test(test_case, the_networks_of_the_study_have_their_parameters);
  tcase_add_test(test_case, a_shape_survives_its_text);
  tcase_add_test(test_case, a_wrong_shape_text_is_refused_by_the_key);
  tcase_add_test(test_case, a_shape_out_of_range_is_refused_by_the_field);
  tcase_add_test(test_case, the_deepest_shape_can_be_evaluated);
  tcase_add_test(test_case, without_raw_skips_the_order_of_vertices_and_tetrahedra_does_not_matter);
  tcase_add_test(test_case, each_raw_skip_of_the_paper_breaks_an_invariance);
  tcase_add_test(test_case, initial_weights_are_a_function_of_the_seed_and_within_their_bounds);
  return suite_run("net_shape", test_case, 60);
}
