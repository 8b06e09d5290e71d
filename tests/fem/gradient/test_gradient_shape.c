// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives by the shape of a body: scale, rotation, rest positions.
#include "differences.h"
#include "fem/model/compliance/compliance.h"

#define UPPER "bodies.upper.place."
#define LOWER "bodies.lower.place."

// Loads by area and volume, weight, and the depth below both surfaces follow the shape.
START_TEST(two_blocks_that_grow_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_blocks",
                       .of = {"displacement:upper:z", "probe:top:z", "position:upper:3:x", "force:upper:z",
                              "patch:patch:z", "moment:upper:x", "reaction:lower:fixed[0]:z",
                              "reaction:upper:fixed[0]:x", "energy", "energy:elastic", "energy:contact",
                              "energy:gravity"},
                       .by = {UPPER "scale", LOWER "scale"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_block_that_grows_along_an_axis_and_turns_agrees_with_differences_of_runs) {
  static const char *const settings[] = {
      "bodies.upper.place={scale: [1.1, 0.9, 1.2], rotate: {axis: [1, 2, 3], degrees: 2}, translate: [0.17, "
      "0.23, 0.499]}",
      "bodies.upper.place={scale: [1.1, 0.9, 1.2], rotate: {axis: [0, 0, 1], degrees: 0}, translate: [0.17, "
      "0.23, 0.499]}"};
  const Asked asked = {.scene = "gradient_blocks",
                       .setting = settings[_i],
                       .of = {"displacement:upper:z", "position:upper:3:x", "force:upper:z",
                              "moment:lower:upper:y", "reaction:lower:fixed[0]:z", "energy"},
                       .by = {UPPER "scale[0]", UPPER "scale[1]", UPPER "scale[2]", UPPER "rotate.degrees"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_slab_of_quadratic_elements_that_grows_agrees_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_shapes",
                       .of = {"displacement:slab:z", "force:slab:bar:z", "force:plate:z", "moment:roll:x",
                              "reaction:slab:fixed[0]:z", "energy"},
                       .by = {"bodies.slab.place.scale"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_driven_slab_that_grows_agrees_with_differences_of_runs) {
  const Asked asked = {
      .scene = "gradient_obstacles",
      .of = {"displacement:slab:z", "force:slab:ball:z", "reaction:slab:driven[0]:z", "energy"},
      .by = {"bodies.slab.place.scale"}};
  check_against_runs(&asked);
}
END_TEST

static const char *const contacts[] = {
    "contact.overlap=geo", "contact.overlap=hybrid",
    "contact={law: {power: {pressure: 1e4, depth: 0.005, exponent: 1.5}}}",
    "contact={law: {exponential: {pressure: 1e4, depth: 0.005}}}",
    "contact={law: {table: [[0, 0], [0.002, 3e3], [0.004, 9e3], [0.01, 5e4]]}}"};

START_TEST(blocks_that_grow_by_learned_overlaps_and_laws_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_blocks",
                       .setting = contacts[_i],
                       .of = {"displacement:upper:z", "position:upper:3:x", "force:upper:z", "moment:upper:x",
                              "energy:elastic"},
                       .by = {UPPER "scale", LOWER "scale"}};
  check_against_runs(&asked);
}
END_TEST

// dg/ds = Σ dg/dX · ∂X/∂s, X = t + s X₀.
START_TEST(derivatives_by_rest_positions_sum_to_that_by_scale) {
  static const double translate[] = {0.17, 0.23, 0.499};
  const char *setting = "bodies.upper.mesh.box.cells=1", *const of[] = {"position:upper:3:x",
                                                                        "moment:upper:x"};
  Asked asked = {.scene = "gradient_blocks", .setting = setting, .of = {of[0], of[1]}, .by = {UPPER "scale"}};
  Answer answer;
  ck_assert_ok(run(&asked, NULL, &answer));
  double whole[2] = {answer.gradient.derivatives[0], answer.gradient.derivatives[1]}, sum[2] = {0, 0};
  destroy(&answer);
  for (int v = 0; v < 8; v++) {
    char keys[3][64];
    for (int c = 0; c < 3; c++) {
      snprintf(keys[c], sizeof keys[c], "bodies.upper.rest[%d][%d]", v, c);
      asked.by[c] = keys[c];
    }
    ck_assert_ok(run(&asked, NULL, &answer));
    for (int i = 0; i < 6; i++)
      sum[i / 3] += answer.gradient.derivatives[i] * (answer.values[i % 3] - translate[i % 3]);
    destroy(&answer);
  }
  for (int g = 0; g < 2; g++) {
    ck_assert_double_gt(fabs(whole[g]), 0);
    ck_assert_near(sum[g] / whole[g], 1, 1e-7);
  }
}
END_TEST

START_TEST(a_stiffness_that_is_chosen_is_kept) {
  static const char *const of[] = {"displacement:upper:z", "energy:contact"};
  Asked asked = {.scene = "gradient_chosen", .of = {of[0], of[1]}, .by = {UPPER "scale"}};
  SceneRun scene;
  char given[128];
  Answer answer;
  ck_assert_ok(run(&asked, NULL, &answer));
  double found[2] = {answer.gradient.derivatives[0], answer.gradient.derivatives[1]};
  destroy(&answer);
  scene_open(&scene, "gradient_chosen", (const char *const[]){NULL});
  FemCompliance choice;
  ck_assert_ok(fem_compliance_choose(&scene.model, &choice));
  snprintf(given, sizeof given, "contact.stiffness=%.17g", choice.stiffness[1]);
  fem_compliance_destroy(&choice);
  scene_close(&scene);
  asked.setting = given;
  ck_assert_ok(run(&asked, NULL, &answer));
  for (int g = 0; g < 2; g++) ck_assert_near(answer.gradient.derivatives[g] / found[g], 1, 1e-6);
  destroy(&answer);
}
END_TEST

static void expect_refusal(const char *scene, const char *setting, const char *of, const char *by,
                           const char *why) {
  const Asked asked = {.scene = scene, .setting = setting, .of = {of}, .by = {by}};
  Answer answer;
  Status status = run(&asked, NULL, &answer);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s by %s: %s", of, by, status_message());
  destroy(&answer);
}

START_TEST(what_has_no_derivative_by_shape_is_refused) {
  const char *up = "displacement:upper:z";
  expect_refusal("gradient_yield", NULL, up, UPPER "scale", "plasticity");
  expect_refusal("gradient_blocks", NULL, "pressure:patch", UPPER "scale", "patch:PROBE");
  expect_refusal("gradient_blocks", "bodies.upper.self_contact=true", up, UPPER "scale", "self_contact");
  expect_refusal("gradient_blocks", "bodies.upper.place.scale=[1, 1, 2]", up, UPPER "scale",
                 "place.scale[0]");
  expect_refusal("gradient_blocks", NULL, up, UPPER "rotate.degrees", "an axis and degrees");
  expect_refusal("gradient_blocks", NULL, up, "bodies.upper.rest[99][0]", "27 vertices");
}
END_TEST

// Vertices at a quarter of the block's length are as far from its side as from its top.
START_TEST(a_kink_of_the_depth_is_told_and_a_common_factor_has_none) {
  const char *cells = "bodies.lower.mesh.box.cells=[4, 4, 2]", *up = "displacement:upper:z";
  const Asked asked = {.scene = "gradient_blocks", .setting = cells, .of = {up}, .by = {LOWER "scale"}};
  expect_refusal("gradient_blocks", cells, up, LOWER "scale[2]", "contact of 'lower'");
  expect_refusal("gradient_blocks", cells, up, LOWER "scale[2]", "equally far from two faces");
  expect_refusal("gradient_blocks", "bodies.upper.mesh.box={size: [1, 1, 0.5], cells: [4, 4, 2]}", up,
                 UPPER "scale[2]", "contact of 'upper'");
  check_against_runs(&asked);
}
END_TEST

// One key with a kink leaves the others their derivatives.
START_TEST(a_kink_by_one_key_is_told_beside_the_derivatives_by_others) {
  const char *cells = "bodies.lower.mesh.box.cells=[4, 4, 2]", *up = "displacement:upper:z";
  const Asked both = {
      .scene = "gradient_blocks", .setting = cells, .of = {up}, .by = {LOWER "scale[2]", LOWER "scale"}};
  const Asked alone = {.scene = "gradient_blocks", .setting = cells, .of = {up}, .by = {LOWER "scale"}};
  Answer answer, other;
  ck_assert_ok(run(&both, NULL, &answer));
  ck_assert_ok(run(&alone, NULL, &other));
  ck_assert_ptr_nonnull(answer.gradient.kinks[0]);
  ck_assert_msg(strstr(answer.gradient.kinks[0], "equally far from two faces") != NULL, "%s",
                answer.gradient.kinks[0]);
  ck_assert(isnan(answer.gradient.derivatives[0]));
  ck_assert_ptr_null(answer.gradient.kinks[1]);
  ck_assert_double_eq(answer.gradient.derivatives[1], other.gradient.derivatives[0]);
  ck_assert_double_ne(answer.gradient.derivatives[1], 0);
  destroy(&answer);
  destroy(&other);
}
END_TEST

START_TEST(a_kink_by_a_key_leaves_derivatives_by_weights) {
  const Asked asked = {.scene = "gradient_blocks",
                       .setting = "bodies.lower.mesh.box.cells=[4, 4, 2]",
                       .of = {"displacement:upper:z"},
                       .by = {LOWER "scale[2]"},
                       .by_weights = true};
  Answer answer;
  double largest = 0;
  ck_assert_ok(run(&asked, "contact.overlap=geo-small", &answer));
  ck_assert_ptr_nonnull(answer.gradient.kinks[0]);
  ck_assert(isnan(answer.gradient.derivatives[0]));
  for (size_t w = 0; w < answer.gradient.weight_count; w++)
    largest = fmax(largest, fabs(answer.gradient.weights[w]));
  ck_assert_double_gt(largest, 0);
  destroy(&answer);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_shape");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, two_blocks_that_grow_agree_with_differences_of_runs);
  tcase_add_loop_test(test_case, a_block_that_grows_along_an_axis_and_turns_agrees_with_differences_of_runs,
                      0, 2);
  tcase_add_test(test_case, a_slab_of_quadratic_elements_that_grows_agrees_with_differences_of_runs);
  tcase_add_test(test_case, a_driven_slab_that_grows_agrees_with_differences_of_runs);
  tcase_add_loop_test(test_case, blocks_that_grow_by_learned_overlaps_and_laws_agree_with_differences_of_runs,
                      0, sizeof contacts / sizeof *contacts);
  tcase_add_test(test_case, derivatives_by_rest_positions_sum_to_that_by_scale);
  tcase_add_test(test_case, a_stiffness_that_is_chosen_is_kept);
  tcase_add_test(test_case, what_has_no_derivative_by_shape_is_refused);
  tcase_add_test(test_case, a_kink_of_the_depth_is_told_and_a_common_factor_has_none);
  tcase_add_test(test_case, a_kink_by_one_key_is_told_beside_the_derivatives_by_others);
  tcase_add_test(test_case, a_kink_by_a_key_leaves_derivatives_by_weights);
  return suite_run("gradient_shape", test_case, 300);
}
