// SPDX-License-Identifier: GPL-3.0-or-later
// What has no gradient in a static scene, or one that is 0.
#include "equilibria.h"
#include "fem/gradient/path/check.h"

// ---- What does not act.

static void expect_idle_with(const char *scene, const char *setting, const char *key, const char *why) {
  const Asked asked = {.scene = scene, .setting = setting, .of = {"displacement:slab:z"}, .by = {key}};
  Answer answer;
  ck_assert_ok(run(&asked, NULL, &answer));
  ck_assert_ptr_nonnull(answer.idle[0]);
  ck_assert_msg(strstr(answer.idle[0], why) != NULL, "%s: %s", key, answer.idle[0]);
  ck_assert(answer.gradient.derivatives[0] == 0);
  destroy(&answer);
}

static void expect_idle(const char *scene, const char *key, const char *why) {
  expect_idle_with(scene, NULL, key, why);
}

START_TEST(what_does_not_act_has_the_derivative_0_and_a_reason) {
  expect_idle("gradient_obstacles", "bodies.slab.material.damping", "motions alone");
  expect_idle("gradient_obstacles", "contact.viscosity", "motions alone");
  expect_idle("gradient_obstacles", "bodies.slab.material.ogden.shares[1]", "law is not ogden");
  expect_idle("gradient_shapes", "bodies.slab.material.mooney", "law is not mooney_rivlin");
  expect_idle("gradient_shapes", "bodies.slab.material.ogden.exponents[2]", "share is 0");
  expect_idle_with("gradient_obstacles",
                   "contact={law: {table: [[0, 0], [0.01, 1e5]]}, pairs: [{bodies: [slab, floor], stiffness: "
                   "2e6}, {bodies: [slab, ball], stiffness: 4e6}]}",
                   "contact.law.table[1][1]", "law of their own");
}
END_TEST

// ---- Refusals.

static const char far_contact[] =
    "obstacles: [{name: far, halfspace: {point: [0, 0, -9], normal: [0, 0, 1]}}]\ncontact: {";

static void expect_refusal_of(const char *text, const char *of, const char *by, const char *why) {
  const Asked asked = {.scene = text, .is_text = true, .of = {of}, .by = {by}};
  Answer answer;
  Status status = run(&asked, NULL, &answer);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s by %s: %s", of, by, status_message());
  ck_assert(!answer.is_done);
  destroy(&answer);
}

// A block with these keys: of the scene's time, its material, itself, its contact (NULL: none).
static void write_block(char text[2048], const char *time, const char *material, const char *keys,
                        const char *contact) {
  snprintf(text, 2048,
           "time: {end: 1, %s}\n"
           "output: {frames: 1}\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [1, 1, 1], cells: 1}}\n"
           "    material: {young: 1e5, density: 1000, %s}\n"
           "    fixed: [{group: z_min}]\n"
           "%s%s%s%s",
           time, material, keys, contact ? far_contact : "", contact ? contact : "", contact ? "}\n" : "");
}

static void refuse(const char *time, const char *material, const char *keys, const char *contact,
                   const char *by, const char *why) {
  char text[2048];
  write_block(text, time, material, keys, contact);
  expect_refusal_of(text, "displacement:block:z", by, why);
}

#define STATIC "static: true"
#define NU "poisson: 0.3"
#define YOUNG "bodies.block.material.young"
START_TEST(what_has_no_gradient_is_refused_by_name) {
  refuse(STATIC, NU, "    loads: [{group: z_max, torque: [0, 0, 1]}]\n", NULL, YOUNG, "loads[0] is a torque");
  refuse(STATIC, NU, "", "stiffness: 1e6, overlap: tpn", YOUNG, "'tpn' has no derivatives of its centroid");
  refuse(STATIC, NU, "", "overlap: geo, law: 1e6*d", YOUNG, "pressure law");
  refuse(STATIC, NU, "", "stiffness: 1e6, potential: nodal", YOUNG, "gradients need field");
}
END_TEST

// What the last state alone does not tell is left to paths.
static void refuse_to_find(const char *name, const char *why) {
  SceneRun scene;
  FemSystem system;
  FemGradient gradient = {0};
  scene_open(&scene, name, NULL);
  ck_assert_ok(fem_system_create(&system, &scene.model));
  ck_assert(fem_gradient_is_path(&scene.model));
  ck_assert_int_eq(fem_gradient_find(&gradient, &system, &(FemGradientDef){0}), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s: %s", name, status_message());
  fem_gradient_destroy(&gradient);
  fem_system_destroy(&system);
  scene_close(&scene);
}

START_TEST(an_equilibrium_alone_is_refused_where_it_does_not_tell) {
  refuse_to_find("gradient_motion", "the scene moves");
  refuse_to_find("gradient_rub", "friction remembers");
  refuse_to_find("gradient_yield", "remembers what has been");
  refuse_to_find("gradient_inflate", "the matrix is not symmetric");
}
END_TEST

static void refuse_start(const char *name, const char *why) {
  SceneRun scene;
  FemStart start = {0};
  scene_open(&scene, name, NULL);
  scene.model.start = &start;
  ck_assert_int_eq(fem_path_check(&scene.model, &(FemGradientDef){0}), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s", status_message());
  scene.model.start = NULL;
  scene_close(&scene);
}

START_TEST(what_remembers_and_goes_on_from_another_run_is_refused) {
  refuse_start("gradient_yield", "start: with plasticity");
  refuse_start("gradient_rub", "start: with friction");
}
END_TEST

START_TEST(parameters_without_a_derivative_are_refused_by_name) {
  const char *load = "    loads: [{group: z_max, force: [0, 0, 0]}]\n";
  const char *driven = "    driven: [{group: z_max, velocity: [0, 0, -1]}]\n";
  refuse(STATIC, NU, "", NULL, "contact.stiffness", "no contact");
  refuse(STATIC, NU, "", "", "contact.stiffness", "chosen");
  refuse(STATIC, NU, "", "stiffness: 1e6", "contact.pairs[0].stiffness",
         "contact.pairs[0].stiffness: contact.pairs has 0 entries, no contact.pairs[0]");
  refuse(STATIC, NU, "", NULL, "bodies.block.material.fibre.modulus", "no fibres");
  refuse(STATIC, NU, "", NULL, "bodies.block.material.plasticity.yield", "body 'block' does not yield");
  refuse(STATIC, NU, "", NULL, "bodies.block.material.fibre.direction[2]", "no fibres");
  refuse(STATIC, NU, "", "stiffness: 1e6", "contact.law.power.depth",
         "contact.law.power.depth: contact has no law");
  refuse(STATIC, NU, "", NULL, "contact.law.power.depth",
         "contact.law.power.depth: the scene has no contact");
  refuse(STATIC, NU, "", "law: 1e6*d", "contact.pairs[7].law.power.depth",
         "contact.pairs[7].law.power.depth: contact.pairs has 0 entries, no contact.pairs[7]");
  refuse(STATIC, NU, "", "stiffness: 1e6, pairs: [{bodies: [block, far], stiffness: 2e6}]",
         "contact.pairs[0].law.power.depth", "contact.pairs[0].law.power.depth: the pair has no law");
  refuse(STATIC, NU, "", "law: {power: {pressure: 1, depth: 1, exponent: 1}}", "contact.law.power.exponent",
         "exponent is 1");
  refuse(STATIC, NU, "", "law: {power: {pressure: 1, depth: 1, exponent: 2}}", "contact.law.table[1][1]",
         "does not have this key");
  refuse(STATIC, NU, "", "law: {table: [[0, 0], [1, 1]]}", "contact.law.table[0][1]", "the rows 1 to 1");
  refuse(STATIC, NU, "", "law: {table: [[0, 0], [1, 1]]}", "contact.law.table[99][1]",
         "contact.law.table[99][1]: the law's table has 2 rows");
  refuse(STATIC, NU, load, NULL, "bodies.block.loads[0].force[2]", "loads[0] is zero");
  refuse(STATIC, NU, load, NULL, "bodies.block.loads[1].force[2]", "no loads[1]");
  refuse(STATIC, NU, load, NULL, "bodies.block.loads[9].pressure",
         "bodies.block.loads[9].pressure: body 'block' has 1 loads, no loads[9]");
  refuse(STATIC, NU, load, NULL, "bodies.block.loads[4294967296].force[2]", "no loads[2147483647]");
  refuse(STATIC, NU, load, NULL, "bodies.block.loads[0].traction[2]", "does not have this key");
  refuse(STATIC, NU, driven, NULL, "bodies.block.driven[1].velocity[2]", "no driven[1]");
  refuse(STATIC, NU, driven, NULL, "bodies.block.driven[0].amplitude[2]", "does not oscillate");
  refuse(STATIC, NU, driven, NULL, "bodies.block.driven[0].spin", "no spin");
  refuse(STATIC, NU, driven, NULL, "bodies.block.driven[0].table[0][1]", "has 0 rows");
  refuse(STATIC, NU, driven, NULL, "bodies.block.driven[0].velocity[3]", "no derivative by");
  refuse(STATIC, "poisson: 0.25", "    element: nodal\n", NULL, "bodies.block.material.poisson",
         "no derivative by ν");
  refuse(STATIC, NU, "", NULL, "bodies.brick.material.young", "there are block");
  refuse(STATIC, NU, "", NULL, "bodies.block.colour", "bodies.block.colour: no derivative by it");
  refuse(STATIC, NU, "", NULL, "output.frames", "output.frames: no derivative by it");
}
END_TEST

START_TEST(quantities_that_are_not_there_are_refused_by_name) {
  static const char *const wrong[][2] = {{"displacement:brick:z", "there are block"},
                                         {"displacement:block:w", "none of the quantities"},
                                         {"height:block:z", "none of the quantities"},
                                         {"energy,energy:elastic", "each has an --of of its own"},
                                         {"position:block:8:z", "has the vertices 0 to 7"},
                                         {"force:block:block:z", "name two"},
                                         {"force:block:wall:z", "there are block, far"},
                                         {"probe:top:z", "there are none"},
                                         {"pressure:top", "there are none"},
                                         {"peak:top:z", "none of the quantities"},
                                         {"patch:top:z", "there are none"},
                                         {"reaction:block:fixed[1]:z", "has 1 such entries"},
                                         {"reaction:block:glued[0]:z", "not fixed[N]"},
                                         {"energy:kinetic", "none of the quantities"},
                                         {"displacement:block:z@soon", "'@soon' is no time"},
                                         {"displacement:block:z@-1", "not within the run"},
                                         {"displacement:block:z@1e-13", "not within the run"},
                                         {"displacement:block:z@1.01", "time.end = 1 s"},
                                         {"energy:gravity", "no effects.gravity"}};
  char text[2048];
  write_block(text, STATIC, NU, "", "stiffness: 1e6");
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    expect_refusal_of(text, wrong[k][0], YOUNG, wrong[k][1]);
  write_block(text, STATIC, NU, "", NULL);
  expect_refusal_of(text, "force:block:z", YOUNG, "no contact");
  expect_refusal_of(text, "energy:contact", YOUNG, "no contact");
  write_block(text, STATIC, NU, "", "law: 1e6*d");
  expect_refusal_of(text, "energy:contact", YOUNG, "without contact.law");
  write_block(text, STATIC, NU, "", "stiffness: 1e6, overlap: geo");
  expect_refusal_of(text, "energy", YOUNG, "clip alone");
  char word[256];
  write_file("wrong.csv", "energy, 1\nenergy, x\n", word, "sum");
  expect_refusal_of(text, word, YOUNG, "wrong.csv:2: expected quantity, weight");
  write_file("empty.csv", "# nothing\n", word, "misfit");
  expect_refusal_of(text, word, YOUNG, "no quantity stands in it");
}
END_TEST

START_TEST(what_is_left_unsolved_is_no_gradient) {
  ck_assert_ok(fem_gradient_judge(1e-7, 0.25));
  ck_assert_int_eq(fem_gradient_judge(1e-5, 0.25), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "t = 0.25 s"));
  ck_assert_int_eq(fem_gradient_judge(NAN, 0.25), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "t = 0.25 s"));
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient refused");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, what_does_not_act_has_the_derivative_0_and_a_reason);
  tcase_add_test(test_case, what_has_no_gradient_is_refused_by_name);
  tcase_add_test(test_case, an_equilibrium_alone_is_refused_where_it_does_not_tell);
  tcase_add_test(test_case, what_remembers_and_goes_on_from_another_run_is_refused);
  tcase_add_test(test_case, parameters_without_a_derivative_are_refused_by_name);
  tcase_add_test(test_case, quantities_that_are_not_there_are_refused_by_name);
  tcase_add_test(test_case, what_is_left_unsolved_is_no_gradient);
  return suite_run("gradient refused", test_case, 100);
}
