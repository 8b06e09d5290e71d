// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of static scenes against central differences of whole runs.
#include "app/gradient/check.h"
#include "differences.h"
#include "weights.h"

#define BODY "bodies.upper."
START_TEST(two_blocks_agree_with_differences_of_runs) {
  const Asked asked = {
      .scene = "gradient_blocks",
      .of = {"displacement:upper:z", "probe:top:z", "position:upper:3:x", "force:upper:z",
             "force:lower:upper:z", "moment:upper:x", "moment:lower:upper:y", "reaction:lower:fixed[0]:z",
             "reaction:upper:fixed[0]:x", "energy", "energy:elastic", "energy:contact", "energy:gravity"},
      .by = {"bodies.lower.material.young", "bodies.lower.material.poisson", BODY "material.poisson",
             BODY "material.density", BODY "loads[0].traction[1]", BODY "loads[1].pressure",
             "contact.stiffness", "effects.gravity[0]", "effects.gravity[2]", BODY "place.translate[1]"}};
  check_against_runs(&asked);
}
END_TEST
#undef BODY

START_TEST(blocks_of_two_materials_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_layers",
                       .of = {"displacement:upper:z", "force:lower:upper:z", "reaction:lower:fixed[0]:z",
                              "reaction:upper:fixed[0]:x", "energy"},
                       .by = {"bodies.lower.material.young", "bodies.lower.materials[0].young",
                              "bodies.lower.materials[0].poisson", "bodies.lower.material.density",
                              "bodies.lower.materials[0].density", "bodies.upper.materials[0].young",
                              "bodies.upper.materials[1].mooney", "bodies.upper.materials[1].density"}};
  check_against_runs(&asked);
}
END_TEST

// Every model that has derivatives of its own; its matrix is that of clipping.
static const char *const learned[] = {"contact.overlap=geo", "contact.overlap=geo-small",
                                      "contact.overlap=hybrid"};

START_TEST(two_blocks_by_learned_overlaps_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_blocks",
                       .setting = learned[_i],
                       .of = {"displacement:upper:x", "position:upper:3:x", "moment:lower:upper:y",
                              "reaction:upper:fixed[0]:x", "energy:elastic"},
                       .by = {"bodies.lower.material.young", "bodies.upper.material.poisson",
                              "bodies.upper.loads[0].traction[1]", "contact.stiffness", "effects.gravity[0]",
                              "bodies.upper.place.translate[1]"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_ball_on_a_slab_by_learned_overlaps_agrees_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_ball",
                       .setting = learned[_i],
                       .of = {"displacement:slab:z", "force:ball:slab:x", "moment:slab:ball:y",
                              "reaction:ball:driven[0]:z", "force:slab:plate:z"},
                       .by = {"bodies.slab.material.young", "bodies.ball.material.poisson",
                              "bodies.ball.driven[0].velocity[2]", "bodies.ball.place.translate[0]",
                              "obstacles.plate.place.translate[1]", "obstacles.plate.motion.velocity[2]"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(slopes_by_weights_agree_with_differences_of_runs) {
  static const char *const scenes[] = {"gradient_blocks", "gradient_ball"};
  static const char *const nets[] = {"geo", "geo-small", "hybrid"};
  const char *body = _i < 3 ? "upper" : "slab", *scene = scenes[_i / 3];
  char setting[400], of[3][64];
  snprintf(of[0], sizeof of[0], "displacement:%s:x", body);
  snprintf(of[1], sizeof of[1], _i < 3 ? "moment:lower:upper:y" : "force:ball:slab:x");
  snprintf(of[2], sizeof of[2], _i < 3 ? "reaction:upper:fixed[0]:x" : "reaction:slab:fixed[0]:z");
  Weights weights = weights_open(nets[_i % 3]);
  weights_write(&weights, 0, setting);
  Asked asked = {.scene = scene, .setting = setting, .of = {of[0], of[1], of[2]}, .by_weights = true};
  Answer answer, moved;
  double found[3] = {0, 0, 0};
  ck_assert_ok(run(&asked, NULL, &answer));
  ck_assert_uint_eq(answer.gradient.weight_count, weights.count);
  asked.by_weights = false;
  for (int k = 0; k < WEIGHTS_PLACES; k++) {
    weights_write(&weights, weights_places[k], setting);
    ck_assert_ok(run(&asked, NULL, &moved));
    for (int g = 0; g < 3; g++) found[g] += weights_factors[k] / weights_step * moved.gradient.values[g];
    destroy(&moved);
  }
  for (int g = 0; g < 3; g++) {
    double along = weights_along(&weights, answer.gradient.weights + weights.count * (size_t)g);
    ck_assert_double_gt(fabs(along), 0);
    ck_assert_msg(fabs(along - found[g]) <= 1e-5 * fabs(along), "%s by %s: along %.12g, runs %.12g, g = %.6g",
                  of[g], nets[_i % 3], along, found[g], answer.gradient.values[g]);
  }
  destroy(&answer);
  weights_close(&weights);
}
END_TEST

#define BODY "bodies.slab."
START_TEST(a_driven_slab_upon_obstacles_agrees_with_differences_of_runs) {
  const Asked asked = {
      .scene = "gradient_obstacles",
      .of = {"displacement:slab:z", "force:slab:ball:z", "force:floor:x", "moment:ball:y", "moment:slab:x",
             "reaction:slab:fixed[0]:x", "reaction:slab:driven[0]:z", "energy", "energy:contact"},
      .by = {BODY "material.young", BODY "material.poisson", BODY "material.mooney",
             BODY "material.fibre.modulus", BODY "material.fibre.direction[1]", BODY "driven[0].velocity[2]",
             BODY "driven[0].amplitude[0]", BODY "driven[0].frequency", BODY "driven[0].spin",
             "obstacles.ball.sphere.centre[2]", "obstacles.ball.motion.velocity[1]",
             "obstacles.floor.halfspace.point[2]", "contact.pairs[0].stiffness", "contact.stiffness",
             BODY "place.translate[0]"}};
  check_against_runs(&asked);
}
END_TEST

// The matrix of a law is that of its energy; the forces, which are summed at two points of a pair, differ.
START_TEST(a_slab_pressed_by_laws_agrees_with_differences_of_runs) {
  const Asked asked = {
      .scene = "gradient_obstacles",
      .setting =
          "contact={law: {power: {pressure: 1e4, depth: 0.005, exponent: 1.7}}, pairs: [{bodies: [slab, "
          "floor], law: {exponential: {pressure: 6e3, depth: 0.004}}}]}",
      .of = {"displacement:slab:z", "force:slab:ball:z", "force:floor:x", "moment:ball:y", "energy:elastic"},
      .by = {BODY "material.young", BODY "material.fibre.direction[0]", "contact.law.power.pressure",
             "contact.law.power.depth", "contact.law.power.exponent",
             "contact.pairs[0].law.exponential.pressure", "contact.pairs[0].law.exponential.depth",
             "obstacles.ball.sphere.centre[2]"}};
  check_against_runs(&asked);
}
END_TEST

static const char *const laws[][3] = {
    {"contact={law: {power: {pressure: 1e4, depth: 0.005, exponent: 1.5}}}", "contact.law.power.exponent",
     "contact.law.power.depth"},
    {"contact={law: {exponential: {pressure: 1e4, depth: 0.005}}}", "contact.law.exponential.pressure",
     "contact.law.exponential.depth"},
    {"contact={law: {table: [[0, 0], [0.002, 3e3], [0.004, 9e3], [0.01, 5e4]]}}", "contact.law.table[1][1]",
     "contact.law.table[2][1]"}};

START_TEST(blocks_pressed_by_a_law_agree_with_differences_of_runs) {
  const Asked asked = {
      .scene = "gradient_blocks",
      .setting = laws[_i][0],
      .of = {"displacement:upper:z", "position:upper:3:x", "force:lower:upper:z", "moment:lower:upper:y"},
      .by = {laws[_i][1], laws[_i][2], "bodies.lower.material.young", "bodies.upper.place.translate[1]"}};
  check_against_runs(&asked);
}
END_TEST

static const char *const patched[] = {NULL, "contact.overlap=geo-small"};

START_TEST(pressures_of_two_blocks_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_blocks",
                       .setting = patched[_i],
                       .of = {"pressure:patch", "peak:patch", "patch:patch:z"},
                       .by = {"bodies.lower.material.young", "bodies.upper.material.poisson",
                              "contact.stiffness", "bodies.upper.loads[1].pressure",
                              "bodies.upper.place.translate[0]"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(pressures_of_shapes_agree_with_differences_of_runs) {
  const Asked shapes = {.scene = "gradient_shapes",
                        .of = {"pressure:below", "peak:below", "patch:below:x", "pressure:above",
                               "peak:above", "patch:above:x"},
                        .by = {BODY "material.poisson", "obstacles.bar.motion.spin",
                               "obstacles.bar.motion.velocity[2]", "obstacles.roll.motion.table[1][3]",
                               "obstacles.plate.motion.spin", "obstacles.plate.place.translate[0]",
                               "obstacles.plate.place.translate[2]"}};
  const Asked pairs = {.scene = "gradient_obstacles",
                       .of = {"pressure:below", "peak:below", "patch:below:z"},
                       .by = {BODY "material.young", "contact.stiffness", "contact.pairs[0].stiffness",
                              "obstacles.floor.halfspace.point[2]", BODY "driven[0].velocity[2]"}};
  check_against_runs(&shapes);
  check_against_runs(&pairs);
}
END_TEST

// An even pressure is mean and peak.
START_TEST(pressures_are_those_of_the_force) {
  const char *even = "time: {end: 1, static: true}\noutput: {frames: 1}\nbodies:\n"
                     "  - name: block\n    mesh: {box: {size: [1, 1, 1], cells: 2}}\n"
                     "    material: {law: linear, young: 1e6, poisson: 0, density: 1000}\n"
                     "    loads: [{group: z_max, traction: [0, 0, -500]}]\n"
                     "    fixed: [{group: z_min, components: [x, y]}]\n"
                     "    probes: [{name: below, group: z_min}]\n"
                     "obstacles: [{name: floor, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
                     "contact: {stiffness: 1e8}\n";
  const Asked asked = {.scene = even,
                       .is_text = true,
                       .of = {"pressure:below", "peak:below", "patch:below:z"},
                       .by = {"bodies.block.loads[0].traction[2]"}};
  Answer answer;
  ck_assert_ok(run(&asked, NULL, &answer));
  // On one square metre, but for the overlap, 5e-6 m deep.
  for (int g = 0; g < 3; g++) {
    ck_assert_near(answer.gradient.values[g], 500, 2e-5 * 500);
    ck_assert_near(answer.gradient.derivatives[g], -1, 2e-5);
  }
  destroy(&answer);
}
END_TEST

START_TEST(quadratic_elements_between_moving_shapes_agree_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_shapes",
                       .of = {"displacement:slab:z", "force:slab:bar:z", "force:plate:z", "moment:bar:y",
                              "moment:roll:x", "reaction:slab:fixed[0]:x", "energy"},
                       .by = {BODY "material.poisson", BODY "material.ogden.exponents[0]",
                              BODY "material.ogden.exponents[1]", BODY "material.ogden.shares[0]",
                              "obstacles.bar.box.centre[2]", "obstacles.bar.motion.spin",
                              "obstacles.bar.motion.velocity[2]", "obstacles.roll.cylinder.centre[2]",
                              "obstacles.roll.motion.table[1][3]", "obstacles.plate.motion.spin",
                              "obstacles.plate.place.translate[0]", "obstacles.plate.place.translate[2]"}};
  check_against_runs(&asked);
}
END_TEST
#undef BODY

START_TEST(a_chosen_stiffness_that_follows_agrees_with_differences_of_runs) {
  const Asked asked = {.scene = "gradient_chosen",
                       .of = {"displacement:upper:z", "moment:upper:x", "energy:contact"},
                       .by = {"bodies.lower.material.young", "bodies.upper.material.young",
                              "bodies.upper.material.poisson", "bodies.lower.material.density"},
                       .follows = true};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_chosen_stiffness_that_is_kept_is_another_derivative) {
  Asked asked = {.scene = "gradient_chosen",
                 .of = {"energy:contact"},
                 .by = {"bodies.lower.material.young"},
                 .follows = true};
  Answer follows, kept;
  ck_assert_ok(run(&asked, NULL, &follows));
  asked.follows = false;
  ck_assert_ok(run(&asked, NULL, &kept));
  // The energy of a given pressure is inverse to κ.
  ck_assert_double_gt(fabs(follows.gradient.derivatives[0] - kept.gradient.derivatives[0]),
                      0.1 * fabs(follows.gradient.derivatives[0]));
  destroy(&follows);
  destroy(&kept);
}
END_TEST

START_TEST(sums_and_misfits_are_those_of_their_terms) {
  char sum[256], misfit[256];
  write_file("sum.csv", "# two\n\nforce:upper:lower:z, 2\n displacement:upper:z , -3e3\n", sum, "sum");
  write_file("misfit.csv", "force:upper:lower:z, 0.5, 2000\ndisplacement:upper:z, 4e6, -0.02\n", misfit,
             "misfit");
  const Asked asked = {.scene = "gradient_blocks",
                       .of = {"force:upper:lower:z", "displacement:upper:z", sum, misfit},
                       .by = {"bodies.upper.material.density", "bodies.lower.material.young"}};
  Answer answer;
  ck_assert_ok(run(&asked, NULL, &answer));
  const double *q = answer.gradient.values, *d = answer.gradient.derivatives;
  double gaps[2] = {q[0] - 2000, q[1] + 0.02};
  ck_assert_near(q[2], 2 * q[0] - 3e3 * q[1], 1e-12 * fabs(q[2]));
  ck_assert_near(q[3], 0.25 * gaps[0] * gaps[0] + 2e6 * gaps[1] * gaps[1], 1e-12 * fabs(q[3]));
  for (int p = 0; p < 2; p++) {
    double f = d[p], z = d[2 + p], scale = fabs(f) + fabs(z);
    ck_assert_near(d[4 + p], 2 * f - 3e3 * z, 1e-8 * (2 * fabs(f) + 3e3 * fabs(z)));
    ck_assert_near(d[6 + p], 0.5 * gaps[0] * f + 4e6 * gaps[1] * z, 1e-8 * (4e6 + fabs(gaps[0])) * scale);
  }
  destroy(&answer);
}
END_TEST

START_TEST(goals_at_earlier_times_agree_with_differences_of_runs) {
  char misfit[256];
  write_file("path.csv", "force:upper:lower:z@0.4, 1e-6, 1000\nforce:upper:lower:z@0.7, 1e-6, 1000\n", misfit,
             "misfit");
  const Asked asked = {
      .scene = "gradient_blocks",
      .of = {"displacement:upper:z@0.4", "reaction:lower:fixed[0]:z@0.7", "energy", misfit},
      .by = {"bodies.lower.material.young", "bodies.upper.material.density", "contact.stiffness"}};
  check_against_runs(&asked);
}
END_TEST

START_TEST(a_run_with_goals_ends_at_the_last_of_them) {
  const Asked alone = {.scene = "gradient_blocks", .of = {"energy@0.4"}, .by = {"contact.stiffness"}};
  const Asked both = {
      .scene = "gradient_blocks", .of = {"energy@0.4", "energy"}, .by = {"contact.stiffness"}};
  Answer early, late;
  ck_assert_ok(run(&alone, NULL, &early));
  ck_assert_ok(run(&both, NULL, &late));
  ck_assert_near(early.gradient.time, 0.4, 1e-12);
  ck_assert_near(late.gradient.time, 1, 1e-12);
  ck_assert_near(late.gradient.values[0], early.gradient.values[0], 1e-12 * early.gradient.values[0]);
  ck_assert_double_gt(fabs(late.gradient.values[1] / late.gradient.values[0] - 1), 1e-3);
  destroy(&early);
  destroy(&late);
}
END_TEST

// ---- How far to trust it.

// `settings` end with NULL.
static void check_with(const char *name, const char *const *settings, const AppGradientWords *words,
                       AppGradientCheck *check, AppGradientAnswer *answer) {
  char path[512];
  snprintf(path, sizeof path, "%s/tests/scenes/%s.yaml", TETLAP_SOURCE_DIR, name);
  AppJobOptions options = {.scene_path = path, .is_quiet = true};
  for (; *settings; settings++) options.overrides[options.override_count++] = *settings;
  AppJob job;
  ck_assert_ok(app_job_open(&job, &options, NULL, NULL));
  ck_assert_ok(app_gradient_answer(answer, &job.model, words, NULL));
  ck_assert_ok(app_gradient_check(check, &options, &job.model, words, answer));
  app_job_close(&job);
}

START_TEST(a_check_runs_along_a_direction_and_with_half_the_steps) {
  const AppGradientWords words = {.of = {"displacement:upper:z"},
                                  .by = {"bodies.lower.material.young", "contact.stiffness"},
                                  .of_count = 1,
                                  .by_count = 2};
  const char *const none[] = {NULL};
  const AppGradientWords rub = {.of = {"displacement:lower:x"}, .by = {"contact.friction"}, 1, 1};
  AppGradientAnswer answer;
  AppGradientCheck check;
  check_with("gradient_blocks", none, &words, &check, &answer);
  double value = fabs(answer.gradient.values[0]);
  ck_assert_double_gt(fabs(check.along[0]), 1e-2 * value);
  ck_assert_near(check.along[0], check.between[0], 1e-6 * value);
  for (int p = 0; p < 2; p++) ck_assert_double_le(check.halved[0][p], 1e-9); // an equilibrium has no steps
  app_gradient_answer_destroy(&answer);
  check_with("gradient_rub", none, &rub, &check, &answer);
  ck_assert_near(check.along[0], check.between[0], 1e-6 * fabs(answer.gradient.values[0]));
  ck_assert_double_gt(check.halved[0][0], 1e-4); // friction goes another way
  ck_assert_double_lt(check.halved[0][0], 0.1);
  app_gradient_answer_destroy(&answer);
}
END_TEST

// A hard impact has a part in the choice, a gentle one has none. The place has one in a longer fall.
START_TEST(a_check_keeps_what_changes_a_contact_stiffness_that_is_chosen) {
  static const char *const by[] = {"bodies.upper.place.translate[2]", "bodies.upper.velocity[2]",
                                   "bodies.upper.material.density"};
  const char *speeds[] = {"bodies.upper.velocity=[0.1, 0, -0.4]", "bodies.upper.velocity=[0.1, 0, -6]"};
  for (int hard = 0; hard < 2; hard++)
    for (int p = 0; p < 3; p++) {
      const AppGradientWords words = {.of = {"displacement:upper:z"}, .by = {by[p]}, 1, 1};
      const char *const settings[] = {"time.end=0.001", "contact={}", speeds[hard], NULL};
      AppGradientAnswer answer;
      AppGradientCheck check;
      check_with("gradient_motion", settings, &words, &check, &answer);
      ck_assert_msg(isnan(check.between[0]) == (hard && p > 0), "%s, %s: %g", speeds[hard], by[p],
                    check.between[0]);
      app_gradient_answer_destroy(&answer);
    }
}
END_TEST

START_TEST(the_command_prints_scaling_laws) {
  // Displacements stay the same where E and the interface's stiffness grow together.
  char command[2048], line[256];
  double young = NAN, stiffness = NAN;
  snprintf(command, sizeof command,
           "%s gradient %s/examples/26_hertz.yaml -q --of displacement:ground:z "
           "--by bodies.ground.material.young,contact.stiffness",
           TETLAP_PROGRAM, TETLAP_SOURCE_DIR);
  FILE *output = popen(command, "r");
  ck_assert_ptr_nonnull(output);
  while (fgets(line, sizeof line, output)) {
    if (strstr(line, "material.young ")) young = atof(line + strcspn(line, "P") + strlen("Pa"));
    if (strstr(line, "contact.stiffness ")) stiffness = atof(line + strcspn(line, "P") + strlen("Pa/m"));
  }
  ck_assert_int_eq(pclose(output), 0);
  ck_assert_double_gt(fabs(young), 0);
  ck_assert_near(young * 1e6 / (stiffness * 1.25e9), -1, 1e-2);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, two_blocks_agree_with_differences_of_runs);
  tcase_add_test(test_case, blocks_of_two_materials_agree_with_differences_of_runs);
  tcase_add_loop_test(test_case, two_blocks_by_learned_overlaps_agree_with_differences_of_runs, 0, 3);
  tcase_add_loop_test(test_case, a_ball_on_a_slab_by_learned_overlaps_agrees_with_differences_of_runs, 0, 3);
  tcase_add_loop_test(test_case, slopes_by_weights_agree_with_differences_of_runs, 0, 6);
  tcase_add_test(test_case, a_driven_slab_upon_obstacles_agrees_with_differences_of_runs);
  tcase_add_test(test_case, a_slab_pressed_by_laws_agrees_with_differences_of_runs);
  tcase_add_loop_test(test_case, blocks_pressed_by_a_law_agree_with_differences_of_runs, 0, 3);
  tcase_add_loop_test(test_case, pressures_of_two_blocks_agree_with_differences_of_runs, 0, 2);
  tcase_add_test(test_case, pressures_of_shapes_agree_with_differences_of_runs);
  tcase_add_test(test_case, pressures_are_those_of_the_force);
  tcase_add_test(test_case, quadratic_elements_between_moving_shapes_agree_with_differences_of_runs);
  tcase_add_test(test_case, a_chosen_stiffness_that_follows_agrees_with_differences_of_runs);
  tcase_add_test(test_case, a_chosen_stiffness_that_is_kept_is_another_derivative);
  tcase_add_test(test_case, sums_and_misfits_are_those_of_their_terms);
  tcase_add_test(test_case, goals_at_earlier_times_agree_with_differences_of_runs);
  tcase_add_test(test_case, a_run_with_goals_ends_at_the_last_of_them);
  tcase_add_test(test_case, a_check_runs_along_a_direction_and_with_half_the_steps);
  tcase_add_test(test_case, a_check_keeps_what_changes_a_contact_stiffness_that_is_chosen);
  tcase_add_test(test_case, the_command_prints_scaling_laws);
  return suite_run("gradient", test_case, 300);
}
