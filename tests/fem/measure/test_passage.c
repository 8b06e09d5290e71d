// SPDX-License-Identifier: GPL-3.0-or-later
// A run whose bodies passed through each other says so; one whose bodies only met does not.
#include "scene.h"

#include <string.h>

#include "fem/output/trouble.h"

// Runs, whatever becomes of it.
static void run_to_its_end(SceneRun *run, const char *const *overrides) {
  scene_open(run, "pierce", overrides);
  scene_run_from(run, NULL);
}

static void expect_passage(const char *const *overrides, bool has_passed) {
  SceneRun run;
  char text[1024];
  run_to_its_end(&run, overrides);
  const FemTrouble *trouble = &run.result.trouble;
  int last = run.result.trajectory.frame_count - 1, stone = run.model.bodies[1].vertex_begin;
  double height = scene_position(&run, last, stone)[2] - scene_position(&run, last, 0)[2];
  ck_assert_double_gt(run.result.contact.force_max, 0);
  // What truly happened: the stone is on this side of the plate, which bends, or its lower side is beyond the
  // plate's.
  ck_assert(has_passed ? height < 0 : height >= -0.02);
  ck_assert_int_eq(run.status, has_passed ? STATUS_SOLVER : STATUS_OK);
  ck_assert(has_passed == (trouble->of[FEM_TROUBLE_PASSED].steps > 0));
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), has_passed ? "passed through" : "finished");
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert(has_passed == (strstr(text, "passed through each other\n  'plate' and 'stone' at t = ") != NULL));
  scene_close(&run);
}

START_TEST(a_stone_that_goes_through_a_plate_passed) {
  expect_passage((const char *const[]){"contact.stiffness=1e7", NULL}, true);
}
END_TEST

START_TEST(the_same_with_a_potential_without_a_depth) {
  expect_passage((const char *const[]){"contact.potential=nodal", "contact.stiffness=1e4", NULL}, true);
}
END_TEST

START_TEST(a_stone_that_bounces_did_not) {
  expect_passage((const char *const[]){"contact.stiffness=1e10", "time.end=0.006", NULL}, false);
}
END_TEST

// Half of the plate's thickness and more is covered at the deepest.
START_TEST(one_that_bounces_after_a_deep_overlap_did_not) {
  expect_passage((const char *const[]){"contact.stiffness=1e8", NULL}, false);
}
END_TEST

START_TEST(through_an_obstacle_without_a_mesh) {
  SceneRun run;
  const char *const overrides[] = {
      "contact.stiffness=1e7", "bodies.plate.place={translate: [0, 0, -1]}", "bodies.plate.fixed=[]",
      "obstacles=[{name: wall, box: {centre: [0.1, 0.1, 0], size: [0.2, 0.2, 0.01]}}]", NULL};
  run_to_its_end(&run, overrides);
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), "passed through");
  scene_close(&run);
}
END_TEST

static void run_without_passage(SceneRun *run, const char *scene, const char *const *overrides) {
  scene_run(run, scene, overrides);
  ck_assert_double_gt(run->result.contact.force_max, 0);
  ck_assert_int_eq((int)run->result.trouble.of[FEM_TROUBLE_PASSED].steps, 0);
  ck_assert_str_eq(fem_run_outcome(&run->result, run->status), "finished");
}

// At the chosen stiffness: blows of 1.4 and 2.8 times the pressure E that would leave the plate no height.
START_TEST(an_edge_does_not_pass_a_soft_plate) {
  for (int speed = 20; speed <= 40; speed += 20) {
    SceneRun run;
    char velocity[64];
    snprintf(velocity, sizeof velocity, "bodies.spike.velocity=[0, 0, -%d]", speed);
    run_without_passage(
        &run, "spike",
        (const char *const[]){velocity, speed == 40 ? "time.end=0.003" : "time.end=0.006", NULL});
    ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_ENCLOSED].steps, 0);
    ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_WRONG_WAY].steps, 0);
    ck_assert_double_lt(run.result.contact.deepest_overlap_max, 0.5);
    scene_close(&run);
  }
}
END_TEST

// No frame, row or checkpoint holds the state in which the stone has passed; what the message asks for holds
// it.
START_TEST(a_run_ends_before_the_step_that_passes_and_says_what_to_write) {
  SceneRun run;
  run_to_its_end(&run, (const char *const[]){"contact.stiffness=1e7", NULL});
  ck_assert_int_eq(run.status, STATUS_SOLVER);
  const FemTrouble *trouble = &run.result.trouble;
  ck_assert_double_lt(run.result.end_time, trouble->of[FEM_TROUBLE_PASSED].first_time);
  ck_assert_double_lt(trouble->of[FEM_TROUBLE_PASSED].first_time, run.scene.end);
  ck_assert_ptr_nonnull(
      strstr(status_message(), "'plate' and 'stone' would pass through each other (element "));
  const char *advice = strstr(status_message(), "contact: {");
  ck_assert_ptr_nonnull(advice);
  char pairs[128], *end;
  snprintf(pairs, sizeof pairs, "contact.pairs=%s", advice + strlen("contact: {pairs: "));
  ck_assert_ptr_nonnull(end = strstr(pairs, "}]"));
  end[2] = 0;
  scene_close(&run);
  run_without_passage(&run, "pierce", (const char *const[]){"contact.stiffness=1e7", pairs, NULL});
  scene_close(&run);
}
END_TEST

// Where a body of the two is inverted no stiffness helps; a pair with a law has none.
START_TEST(a_body_that_is_inverted_is_to_be_refined) {
  FemTroubleState found = {.count = {[FEM_TROUBLE_INVERTED] = 3, [FEM_TROUBLE_PASSED] = 1}};
  FemTrouble trouble = {.passed = {0, 1}};
  SceneRun run;
  char text[1024];
  scene_open(&run, "pierce", NULL);
  fem_trouble_describe_refusal(&trouble, &run.model, &found, 1e7, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "3 elements are inverted, element 0 of body 'plate' first"));
  ck_assert_ptr_null(strstr(text, "contact: {"));
  trouble.passed[0] = 1, trouble.passed[1] = 1; // what is inverted elsewhere says nothing here
  fem_trouble_describe_refusal(&trouble, &run.model, &found, 0, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "a steeper contact.law"));
  scene_close(&run);
}
END_TEST

// A blow folds a plate of two layers: it gains no energy of that, though the edge passes in the end.
START_TEST(a_folded_plate_gains_no_energy) {
  SceneRun run;
  scene_open(&run, "spike", (const char *const[]){"bodies.plate.mesh.box.cells=[16, 16, 2]", NULL});
  scene_run_from(&run, NULL);
  const FemTrouble *trouble = &run.result.trouble;
  ck_assert_int_gt((int)trouble->of[FEM_TROUBLE_INVERTED].steps, 100);
  ck_assert_int_eq((int)trouble->of[FEM_TROUBLE_ENERGY].steps, 0);
  scene_close(&run);
}
END_TEST

// From its first frame to its last.
static double way_of(const SceneRun *run, int vertex, int axis) {
  return scene_position(run, run->result.trajectory.frame_count - 1, vertex)[axis] -
         scene_position(run, 0, vertex)[axis];
}

// A block down an incline, by more than an element is wide: ½ g (sin α − μ cos α) t² = 0.079 m; and a strip
// that is drawn over an edge.
START_TEST(what_slides_does_not_pass) {
  SceneRun run;
  run_without_passage(&run, "incline", (const char *const[]){"time.end=0.3", "contact.friction=0.3", NULL});
  ck_assert_near(way_of(&run, 0, 0), 0.079, 0.004);
  scene_close(&run);
  run_without_passage(&run, "drag", (const char *const[]){"time.end=0.1", NULL});
  scene_close(&run);
}
END_TEST

// A cube that slides over the top of a large ball, in units of which the metre has `unit`.
static double slide_over_a_ball(double unit) {
  SceneRun run;
  char texts[6][200];
  snprintf(texts[0], sizeof texts[0], "bodies.cube.place={scale: %g, translate: [%g, %g, %g]}", unit,
           -0.1 * unit, -0.1 * unit, 0.002 * unit);
  snprintf(texts[1], sizeof texts[1], "bodies.cube.material={young: %g, poisson: 0.3, density: %g}",
           1e5 / unit, 1e3 / (unit * unit * unit));
  snprintf(texts[2], sizeof texts[2], "bodies.cube.velocity=[%g, 0, 0]", unit);
  snprintf(texts[3], sizeof texts[3], "effects.gravity=[0, 0, %g]", -10 * unit);
  snprintf(texts[4], sizeof texts[4], "obstacles=[{name: ball, sphere: {centre: [0, 0, %g], radius: %g}}]",
           -2 * unit, 2 * unit);
  snprintf(texts[5], sizeof texts[5], "bodies.cube.mesh.box.cells=[3, 3, 3]");
  run_without_passage(&run, "obstacle_shapes",
                      (const char *const[]){texts[0], texts[1], texts[2], texts[3], texts[4], texts[5],
                                            "contact.friction=0.3", NULL});
  ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_ENCLOSED].steps, 0);
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), "finished");
  double way = scene_position(&run, run.result.trajectory.frame_count - 1, 0)[0] - run.model.rest[0];
  scene_close(&run);
  return way / unit;
}

START_TEST(what_slides_over_a_ball_does_not_pass_in_any_unit) {
  double way = slide_over_a_ball(1);
  ck_assert_double_gt(way, 0.05);
  ck_assert_near(slide_over_a_ball(1000), way, 1e-3 * way);
}
END_TEST

// A block that is pressed on another one and turned, in units of which the metre has `unit`: edges and
// corners leave the other's faces, and touch them by rounding.
static void turn_on_a_block(double unit) {
  SceneRun run;
  char texts[6][256];
  const char *const bodies[2] = {"lower", "upper"};
  for (int b = 0; b < 2; b++) {
    snprintf(texts[b], sizeof texts[b],
             "bodies.%s.material={law: corotational, young: %g, poisson: 0.3, density: %g}", bodies[b],
             1e6 / unit, 1e3 / (unit * unit * unit));
    snprintf(texts[2 + b], sizeof texts[2 + b], "bodies.%s.mesh.box.size=[%g, %g, %g]", bodies[b], 0.1 * unit,
             0.1 * unit, 0.05 * unit);
  }
  snprintf(texts[4], sizeof texts[4], "bodies.upper.place={translate: [0, 0, %g]}", 0.05 * unit);
  snprintf(texts[5], sizeof texts[5],
           "bodies.upper.driven=[{group: z_max, formula: {z: '%g*min(4*t,1)'}, "
           "turn: {axis: [0, 0, 1], centre: [%g, %g, 0], angle: '0.6*max(t-0.25,0)'}}]",
           -2e-4 * unit, 0.05 * unit, 0.05 * unit);
  run_without_passage(&run, "patch",
                      (const char *const[]){texts[0], texts[1], texts[2], texts[3], texts[4], texts[5],
                                            "bodies.lower.fixed=[{group: z_min}]", "bodies.upper.fixed=[]",
                                            "bodies.upper.loads=[]", "contact={friction: 0.3}",
                                            "output.frames=8", NULL});
  ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_ENCLOSED].steps, 0);
  int corner = run.model.bodies[1].vertex_end - 1;
  ck_assert_near(hypot(way_of(&run, corner, 0), way_of(&run, corner, 1)) / unit,
                 2 * sin(0.225) * 0.05 * sqrt(2), 1e-6);
  scene_close(&run);
}

START_TEST(what_is_turned_on_a_block_does_not_pass_in_any_unit) {
  turn_on_a_block(1);
  turn_on_a_block(1000);
}
END_TEST

// A ball that turns over: the vertex that was its top comes to lie lower than its middle.
START_TEST(what_rolls_does_not_pass) {
  SceneRun run;
  run_without_passage(&run, "bowl", NULL);
  int top = 0;
  for (int v = 0; v < run.model.vertex_count; v++)
    if (scene_position(&run, 0, v)[2] > scene_position(&run, 0, top)[2]) top = v;
  double radius = scene_position(&run, 0, top)[2] / 2, lowest = INFINITY;
  for (int f = 0; f < run.result.trajectory.frame_count; f++)
    lowest = fmin(lowest, scene_position(&run, f, top)[2]);
  ck_assert_double_lt(lowest, 0.5 * radius);
  scene_close(&run);
}
END_TEST

START_TEST(what_sleeps_and_is_awakened_does_not_pass) {
  SceneRun run;
  run_without_passage(&run, "asleep", NULL);
  ck_assert_double_ge(record_find_number(run.result.counters, "bodies_put_to_rest"), 2);
  ck_assert_double_ge(record_find_number(run.result.counters, "bodies_awakened"), 2);
  scene_close(&run);
}
END_TEST

// The stone lies in the plate from the start: in all of its thickness, or in a tenth of it, as in a press
// fit.
START_TEST(bodies_that_begin_inside_each_other_do_not_end_well) {
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char place[64];
    snprintf(place, sizeof place, "bodies.stone.place.translate=[0.083, 0.077, %g]", k == 0 ? -0.015 : 0.009);
    scene_run(&run, "pierce",
              (const char *const[]){
                  place, "bodies.plate.mesh={box: {size: [0.2, 0.2, 0.01], cells: [20, 20, 1]}}",
                  "bodies.stone.velocity=[0, 0, 0]", "contact.stiffness=1e4", "time.end=1e-4", NULL});
    ck_assert_str_eq(fem_run_outcome(&run.result, run.status), k == 0 ? "inside each other" : "finished");
    scene_close(&run);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("passage");
  tcase_add_test(cases, a_stone_that_goes_through_a_plate_passed);
  tcase_add_test(cases, the_same_with_a_potential_without_a_depth);
  tcase_add_test(cases, a_stone_that_bounces_did_not);
  tcase_add_test(cases, one_that_bounces_after_a_deep_overlap_did_not);
  tcase_add_test(cases, through_an_obstacle_without_a_mesh);
  tcase_add_test(cases, an_edge_does_not_pass_a_soft_plate);
  tcase_add_test(cases, a_run_ends_before_the_step_that_passes_and_says_what_to_write);
  tcase_add_test(cases, a_body_that_is_inverted_is_to_be_refined);
  tcase_add_test(cases, a_folded_plate_gains_no_energy);
  tcase_add_test(cases, what_slides_does_not_pass);
  tcase_add_test(cases, what_rolls_does_not_pass);
  tcase_add_test(cases, what_slides_over_a_ball_does_not_pass_in_any_unit);
  tcase_add_test(cases, what_is_turned_on_a_block_does_not_pass_in_any_unit);
  tcase_add_test(cases, what_sleeps_and_is_awakened_does_not_pass);
  tcase_add_test(cases, bodies_that_begin_inside_each_other_do_not_end_well);
  return suite_run("passage", cases, 60);
}
