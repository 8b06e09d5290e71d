// SPDX-License-Identifier: GPL-3.0-or-later
// How wrong contact may be, as a run estimates it, against how wrong it is: the same with a stiffness a
// hundred and more times as large.
#include "scene.h"

#include <math.h>
#include <string.h>

#include "fem/measure/accuracy.h"

typedef struct Told {
  double force, give, rim, stiffness_for, by_tolerance, tolerance_for, elements;
  bool asks_for_mesh; // in the words of the run
} Told;

// Of the pair that presses most in that scene, at that stiffness.
static Told run_with(const char *path, const char *const *overrides, double stiffness) {
  SceneRun run = {0};
  char set[64];
  const char *all[16] = {set};
  int count = 1;
  snprintf(set, sizeof set, "contact.stiffness=%g", stiffness);
  while (overrides && overrides[count - 1]) all[count] = overrides[count - 1], count++;
  ck_assert_ok(app_scene_read(path, all, count, &run.scene));
  ck_assert_ok(fem_model_create(&run.model, &run.scene));
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  const Record *contact = record_at(record_find(run.result.account.record, "contacts"), 0);
  const Record *estimate = record_find(contact, "estimate");
  Told told = {.force = record_find_number(contact, "force_max_N"),
               .give = record_find_number(estimate, "give"),
               .rim = record_find_number(estimate, "rim"),
               .stiffness_for = record_find_number(estimate, "stiffness_for_1_percent"),
               .by_tolerance = record_find_number(estimate, "tolerance_over_depth"),
               .tolerance_for = record_find_number(estimate, "tolerance_for_1_percent"),
               .elements = record_find_number(estimate, "elements_across"),
               .asks_for_mesh = strstr(run.result.account.contacts[0], "refine") != NULL};
  scene_close(&run);
  return told;
}

// The estimate is within a factor of two of the force that is missing.
static void expect_honest(const char *path, const char *const *overrides, double stiffness, double stiffest) {
  Told told = run_with(path, overrides, stiffness), reference = run_with(path, overrides, stiffest);
  double missing = 1 - told.force / reference.force;
  ck_assert_double_gt(missing, 1e-3);
  ck_assert_msg(told.give > 0.5 * missing && told.give < 2 * missing, "c = %g: told %g, missing %g",
                stiffness, told.give, missing);
}

static const char *const pressed[] = {
    "bodies.upper.loads=[]",
    "bodies.upper.driven=[{group: z_max, components: [z], velocity: [0, 0, -0.001]}]", NULL};

START_TEST(the_give_of_two_blocks_in_a_press) {
  expect_honest(TETLAP_SOURCE_DIR "/tests/scenes/patch.yaml", pressed, 2e7, 1e10);
  expect_honest(TETLAP_SOURCE_DIR "/tests/scenes/patch.yaml", pressed, 1.25e8, 1e10);
}
END_TEST

START_TEST(the_give_under_a_ball) {
  expect_honest(TETLAP_SOURCE_DIR "/examples/26_hertz.yaml", NULL, 1.25e8, 1.25e10);
  expect_honest(TETLAP_SOURCE_DIR "/examples/26_hertz.yaml", NULL, 1.25e9, 2.5e10);
}
END_TEST

// Rigid, as it were: one block overlaps another by d at once. Full pressure would be 2 c d everywhere.
START_TEST(what_a_rim_loses_at_a_given_depth) {
  const double depth = 2e-4, stiffness = 1e5;
  char place[96];
  snprintf(place, sizeof place, "bodies.upper.place={translate: [0.02, 0.02, %.17g]}", 0.05 - depth);
  const char *const overrides[] = {place,
                                   "bodies.upper.mesh={box: {size: [0.05, 0.05, 0.05], cells: [5, 5, 5]}}",
                                   "bodies.upper.fixed=[{group: z_max}]",
                                   "bodies.lower.fixed=[{group: z_min}]",
                                   "bodies.upper.material={young: 1e13, poisson: 0, density: 1000}",
                                   "bodies.lower.material={young: 1e13, poisson: 0, density: 1000}",
                                   "bodies.upper.loads=[]",
                                   "output.frames=1",
                                   NULL};
  Told told = run_with(TETLAP_SOURCE_DIR "/tests/scenes/patch.yaml", overrides, stiffness);
  double lost = 1 - told.force / (2 * stiffness * depth * 0.05 * 0.05);
  ck_assert_double_gt(lost, 1e-3);
  ck_assert_msg(told.rim > 0.5 * lost && told.rim < 2 * lost, "told %g, lost %g", told.rim, lost);
}
END_TEST

// With the stiffness that the estimate asks for, it is what was asked for.
START_TEST(the_advice_leads_to_a_hundredth) {
  const char *path = TETLAP_SOURCE_DIR "/tests/scenes/patch.yaml";
  Told told = run_with(path, pressed, 2e7), advised = run_with(path, pressed, told.stiffness_for);
  ck_assert_double_gt(told.give, 0.1);
  ck_assert(advised.give > 0.005 && advised.give < 0.0105);
}
END_TEST

// A block that falls gives way long after the blow has pressed its contact most: the way is that of both.
START_TEST(what_gives_way_after_a_blow_counts) {
  const char *const overrides[] = {"output.frames=1", NULL};
  Told told = run_with(TETLAP_SOURCE_DIR "/examples/01_drop.yaml", overrides, 2.5e7);
  // p/c against p L / 2E of a block under a pressure that falls to 0 at its top: c L / 2E = 25.
  ck_assert_double_gt(told.give, 0.005);
  ck_assert_double_lt(told.give, 0.1);
}
END_TEST

// The give of two blocks pressed by p = P (d/D)² until t = 1 and hardly any more at t = 2, when a third body
// far away is pulled by `pull` [Pa].
static double give_beside(double pull) {
  static const char body[] =
      "{name: %s, mesh: {box: {size: [0.1, 0.1, 0.05], cells: 2}}, place: {translate: [%g, 0, %g]}, "
      "material: "
      "{young: 1e6, poisson: 0.3, density: 1000}, fixed: [{group: x_min, components: [x]}, {group: y_min, "
      "components: [y]}%s], loads: [{group: z_max, traction: [0, 0, %g], table: %s}]}";
  char bodies[2048];
  int length = snprintf(bodies, sizeof bodies, "bodies=[");
  const char *const held = ", {group: z_min, components: [z]}";
  length += snprintf(bodies + length, sizeof bodies - (size_t)length, body, "lower", 0.0, 0.0, held, 0.0,
                     "[[0, 0]]");
  length += snprintf(bodies + length, sizeof bodies - (size_t)length, ",");
  length += snprintf(bodies + length, sizeof bodies - (size_t)length, body, "upper", 0.0, 0.05, "", -1e4,
                     "[[0, 0], [1, 1], [2, 0.05]]");
  length += snprintf(bodies + length, sizeof bodies - (size_t)length, ",");
  snprintf(bodies + length, sizeof bodies - (size_t)length, body, "other", 1.0, 0.0, held, pull,
           "[[0, 0], [1, 0], [2, 1]]");
  strcat(bodies, "]");
  SceneRun run;
  scene_run(&run, "patch",
            (const char *const[]){bodies, "contact={law: {power: {exponent: 2, pressure: 1e4, depth: 1e-4}}}",
                                  "time.end=2", "output.frames=8", NULL});
  const Record *contact = record_at(record_find(run.result.account.record, "contacts"), 0);
  double give = record_find_number(record_find(contact, "estimate"), "give");
  ck_assert_double_eq(record_find_number(record_find(contact, "estimate"), "give_time"), 1);
  scene_close(&run);
  return give;
}

START_TEST(what_others_store_does_not_count) {
  // The interface's share of the way at the peak: D of it, of each block p/E of its height.
  const double by_hand = 1e-4 / (1e-4 + 2 * 1e4 / 1e6 * 0.05);
  ck_assert_near(give_beside(0) / by_hand, 1, 0.1); // told as energies, of a pressure that is not quite even
  ck_assert_near(give_beside(1e5) / give_beside(0), 1, 1e-3);
}
END_TEST

// Four elements across a patch ask for a finer mesh, eight do not.
START_TEST(a_mesh_too_coarse_for_its_patch_is_to_be_refined) {
  const char *const coarse[] = {"output.frames=1", "time.end=0.11", NULL},
                    *const fine[] = {"output.frames=1", "time.end=0.11", "bodies.block.mesh.box.cells=9",
                                     NULL};
  const char *path = TETLAP_SOURCE_DIR "/examples/01_drop.yaml";
  Told four = run_with(path, coarse, 2.5e7), nine = run_with(path, fine, 2.5e7);
  ck_assert_double_lt(four.elements, 5);
  ck_assert(four.asks_for_mesh);
  ck_assert_double_gt(nine.elements, 5);
  ck_assert(!nine.asks_for_mesh);
}
END_TEST

// Bodies so stiff that the depth is less than a step of a motion can tell need no other stiffness.
START_TEST(no_stiffness_is_advised_for_a_depth_that_no_step_can_tell) {
  const char *const overrides[] = {"output.frames=1", "time.end=0.2", NULL};
  Told told = run_with(TETLAP_SOURCE_DIR "/examples/10_incline.yaml", overrides, 5e8);
  ck_assert_double_gt(told.force, 0);
  ck_assert_double_gt(told.give, 0.01);
  ck_assert(isnan(told.stiffness_for));
}
END_TEST

// The peak force of a drop errs by three times the estimate at most (docs/contact_error.md), the estimate
// falls with the tolerance, and the tolerance that it asks for leads to a hundredth.
START_TEST(the_tolerance_bounds_the_error_of_a_peak_force) {
  const char *path = TETLAP_SOURCE_DIR "/examples/01_drop.yaml";
  Told coarse = run_with(path, (const char *const[]){"output.frames=1", "time.tolerance=1e-3", NULL}, 2.5e7),
       fine = run_with(path, (const char *const[]){"output.frames=1", "time.tolerance=1e-5", NULL}, 2.5e7);
  double error = fabs(coarse.force / fine.force - 1);
  ck_assert_double_gt(error, 1e-3);
  ck_assert_double_lt(error, 3 * coarse.by_tolerance);
  ck_assert_near(fine.by_tolerance, 0.01 * coarse.by_tolerance, 0.3 * fine.by_tolerance);
  char wanted[64];
  snprintf(wanted, sizeof wanted, "time.tolerance=%g", coarse.tolerance_for);
  Told advised = run_with(path, (const char *const[]){"output.frames=1", wanted, NULL}, 2.5e7);
  ck_assert_double_lt(advised.by_tolerance, 0.013);
  ck_assert_double_lt(fabs(advised.force / fine.force - 1), 0.03);
}
END_TEST

// A quarter of a shaft in a quarter of a hole: of an even pressure p the resultant is √2 p R b, pressure
// times area π/2 p R b. Round the whole shaft the first would be nothing.
START_TEST(pressure_times_area_is_told_beside_the_resultant) {
  SceneRun run;
  scene_run(&run, "shaft", NULL);
  const Record *contact = record_at(record_find(run.result.account.record, "contacts"), 0);
  double area_pressure = record_find_number(contact, "pressed_max_N"),
         theory = 0.01 * 1e6 / 0.91 * 3 / 8 * 0.15 * M_PI / 2;
  ck_assert_near(area_pressure, theory, 0.05 * theory);
  ck_assert_near(area_pressure / record_find_number(contact, "force_max_N"), M_PI / 2 / sqrt(2), 0.03);
  ck_assert_double_eq(record_find_number(contact, "pressed_max_time"), 1);
  scene_close(&run);
}
END_TEST

static void accept(FemAccuracy *accuracy, double time, double value) {
  FemAccuracyPair *pair = &accuracy->pairs[0];
  accuracy->time = time;
  accuracy->pressed[0] = accuracy->forces[0] = value;
  if (value > pair->pressed) pair->pressed = pair->estimated = value, pair->time = time;
  fem_accuracy_accept(accuracy);
}

// 4.1 times the plateau in one step; where a part of a run begins anew, its first state does not count twice.
START_TEST(a_peak_that_lasts_one_step_is_told_as_such) {
  SceneRun run;
  scene_open(&run, "drop", NULL);
  FemAccuracyPair pair = {.seen = -INFINITY, .edge = 1, .energy = 1};
  double area_pressure, force;
  FemAccuracy accuracy = {.count = 1, .pairs = &pair, .pressed = &area_pressure, .forces = &force};
  const double values[] = {0, 9, 10, 41, 41, 10}, times[] = {0, 1, 2, 3, 3, 4};
  for (int k = 0; k < 6; k++) accept(&accuracy, times[k], values[k]);
  ck_assert_double_eq(pair.held, 10);
  ck_assert(fem_accuracy_estimate(&pair, &run.model, 1).is_brief);
  accept(&accuracy, 5, 40), accept(&accuracy, 6, 39);
  ck_assert_double_eq(pair.held, 39);
  ck_assert(!fem_accuracy_estimate(&pair, &run.model, 1).is_brief);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("accuracy");
  tcase_add_test(cases, pressure_times_area_is_told_beside_the_resultant);
  tcase_add_test(cases, a_peak_that_lasts_one_step_is_told_as_such);
  tcase_add_test(cases, the_give_of_two_blocks_in_a_press);
  tcase_add_test(cases, the_give_under_a_ball);
  tcase_add_test(cases, what_a_rim_loses_at_a_given_depth);
  tcase_add_test(cases, the_advice_leads_to_a_hundredth);
  tcase_add_test(cases, what_gives_way_after_a_blow_counts);
  tcase_add_test(cases, what_others_store_does_not_count);
  tcase_add_test(cases, a_mesh_too_coarse_for_its_patch_is_to_be_refined);
  tcase_add_test(cases, no_stiffness_is_advised_for_a_depth_that_no_step_can_tell);
  tcase_add_test(cases, the_tolerance_bounds_the_error_of_a_peak_force);
  return suite_run("accuracy", cases, 60);
}
