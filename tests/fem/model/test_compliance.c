// SPDX-License-Identifier: GPL-3.0-or-later
// The contact stiffness where surfaces curve, and how often their edges are halved.
#include "fem/model/compliance/compliance.h"

#include <math.h>
#include <stdio.h>

#include "fem/model/compliance/patch.h"
#include "scene.h"

static void choose(SceneRun *run, const char *name, const char *const *overrides, FemCompliance *choice) {
  scene_open(run, name, overrides);
  ck_assert_ok(fem_compliance_choose(&run->model, choice));
}

static void forget(SceneRun *run, FemCompliance *choice) {
  fem_compliance_destroy(choice);
  scene_close(run);
}

START_TEST(bodies_of_flat_faces_are_pressed_by_their_heights) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/05_press", NULL, &choice);
  for (int a = 0; a < run.model.body_count; a++) ck_assert_int_eq(choice.levels[a], 0);
  ck_assert_int_ge(run.model.body_count, 2);
  for (int k = 0; k < run.model.body_count * choice.party_count; k++)
    ck_assert_int_eq(choice.bounds[k], FEM_COMPLIANCE_BODIES);
  forget(&run, &choice);
}
END_TEST

// Of edges h round the surfaces, whose strips are one element wide: c ≤ 1/(.5 Σ h/E').
START_TEST(a_shaft_in_a_hole_is_no_stiffer_than_its_elements) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/validation/shaft", NULL, &choice);
  double stiff = 1e6 / (1 - 3.5 * 0.3 * 0.3 * 0.3 * 0.3), edges = 2 * sin(M_PI / 32) + 2 * sin(M_PI / 40);
  ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_ELEMENTS);
  ck_assert_near(choice.stiffness[1], stiff / (0.5 * edges), 0.02 * choice.stiffness[1]);
  ck_assert_int_eq(choice.levels[0], 2);
  ck_assert_int_eq(choice.levels[1], 2);
  forget(&run, &choice);
}
END_TEST

START_TEST(fewer_elements_in_a_patch_are_halved_more) {
  static const char *const FINE[] = {"bodies.lower.mesh.size=0.01", "bodies.upper.mesh.size=0.01", NULL};
  SceneRun run;
  FemCompliance coarse, fine;
  choose(&run, "../../examples/validation/crossed", NULL, &coarse);
  ck_assert_int_eq(coarse.levels[0], 1);
  ck_assert_int_eq(coarse.bounds[1], FEM_COMPLIANCE_ELEMENTS);
  double soft = coarse.stiffness[1];
  forget(&run, &coarse);
  choose(&run, "../../examples/validation/crossed", FINE, &fine);
  ck_assert_int_eq(fine.levels[0], 0);
  ck_assert_double_gt(fine.stiffness[1], 1.5 * soft);
  forget(&run, &fine);
}
END_TEST

// A ball that is moved over a slab: no load, no blow and no static travel tells how wide its contact becomes.
START_TEST(a_patch_that_nothing_tells_leaves_the_rule_of_the_bodies) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/11_rolling_ball", NULL, &choice);
  ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_BODIES);
  forget(&run, &choice);
}
END_TEST

// It has no resultant, and no forces of vertices that would be summed.
START_TEST(a_torque_tells_no_patch) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/validation/crossed",
         (const char *const[]){"bodies.upper.loads=[{all: true, torque: [0, 1, 0]}]", NULL}, &choice);
  ck_assert_double_eq(fem_patch_load(&run.model, 1), 0);
  forget(&run, &choice);
}
END_TEST

// The two faces at the ends of the axis are half discs; a pressure that follows one presses along the axis.
START_TEST(a_pressure_tells_its_patch_whether_it_follows_or_not) {
  static const char *const FOLLOWS[] = {"surface", "nothing"};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char load[160];
    snprintf(load, sizeof load,
             "bodies.upper.loads=[{normal: {direction: [0, 1, 0]}, pressure: 1000, follows: %s}]",
             FOLLOWS[k]);
    scene_open(&run, "../../examples/validation/crossed", (const char *const[]){load, NULL});
    ck_assert_near(fem_patch_load(&run.model, 1), 1000 * M_PI * 0.01 / 2, 0.05 * 1000 * M_PI * 0.01 / 2);
    scene_close(&run);
  }
}
END_TEST

// It is zero at the 65 times that divide the run evenly.
START_TEST(a_motion_with_a_short_period_is_seen) {
  SceneRun run;
  scene_open(&run, "../../examples/validation/crossed",
             (const char *const[]){"bodies.upper.driven[0].formula.z=0.006*sin(64*pi*t)", NULL});
  ck_assert_near(fem_patch_travel(&run.model, 1), 0.006, 1e-4);
  scene_close(&run);
}
END_TEST

// One row of a table between two of the times that are looked at.
START_TEST(a_short_peak_of_a_table_is_seen) {
  SceneRun run;
  scene_open(
      &run, "../../examples/validation/crossed",
      (const char *const[]){"bodies.upper.driven[0]={group: base, table: [[0, 0, 0, 0], [0.4999, 0, 0, 0], "
                            "[0.5, 0, 0, -0.006], [0.5001, 0, 0, 0]]}",
                            NULL});
  ck_assert_near(fem_patch_travel(&run.model, 1), 0.006, 1e-12);
  scene_close(&run);
}
END_TEST

// Balls are pressed together by 5 mm, then turned on each other: no vertex lies on the axis. One that turns
// about an axis beside it moves.
START_TEST(a_turn_about_an_axis_amid_what_is_driven_is_no_approach) {
  static const char *const BESIDE[] = {"bodies.upper.driven[0].turn.axis=[0, 1, 0]",
                                       "bodies.upper.driven[0].turn.centre=[3, 0, 0]", NULL};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_open(&run, "../../examples/validation/torsion", k ? BESIDE : NULL);
    double travel = fem_patch_travel(&run.model, 1);
    if (k)
      ck_assert_double_gt(travel, 0.04);
    else
      ck_assert_near(travel, 0.005, 1e-12);
    scene_close(&run);
  }
}
END_TEST

// A shaft beside its hole, not in it: nothing lies in a hollow.
START_TEST(a_shaft_beside_a_hole_of_its_radius_lies_in_no_hollow) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/validation/shaft",
         (const char *const[]){"bodies[1].place={translate: [5, 0, 0]}", NULL}, &choice);
  ck_assert_int_lt(choice.levels[0], 2);
  forget(&run, &choice);
}
END_TEST

// A thousand times as large c is a thousandth, in Pa/m, and nothing else changes; nor does it in a scene that
// is turned.
START_TEST(the_choice_knows_no_lengths_and_no_directions) {
  static const char *const LARGE[] = {"bodies.lower.place={scale: 1000}", "bodies.upper.place.scale=1000",
                                      "bodies.upper.driven[0].formula.z=-6*t", NULL};
  static const char *const TURNED[] = {"bodies.lower.place={rotate: {axis: [1, 0, 0], degrees: 180}}",
                                       "bodies.upper.place.rotate={axis: [0, 0, 1], degrees: 90}",
                                       "bodies.upper.driven[0].formula.z=0.006*t", NULL};
  const char *const *const changes[] = {NULL, LARGE, TURNED};
  const double share[] = {1, 1e-3, 1};
  SceneRun run;
  FemCompliance choice;
  double c = 0;
  for (int k = 0; k < 3; k++) {
    choose(&run, "../../examples/validation/crossed", changes[k], &choice);
    if (k == 0) c = choice.stiffness[1];
    ck_assert_near(choice.stiffness[1], share[k] * c, 1e-6 * share[k] * c);
    ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_ELEMENTS);
    ck_assert_int_eq(choice.levels[0], 1);
    forget(&run, &choice);
  }
}
END_TEST

// c = 2 D/λ⁴, D of both, λ³ = 1.5 L h²; in a scene that is turned, too.
START_TEST(leaves_that_bend_together_are_no_stiffer_than_their_elements) {
  static const char *const TURNED[] = {
      "bodies.upper.place={rotate: {axis: [0, 0, 1], degrees: 90}, translate: [0, 0, 0.002]}",
      "bodies.lower.place={rotate: {axis: [0, 0, 1], degrees: 90}}",
      "bodies.upper.fixed=[{box: {min: [-1, -1, -1], max: [1, 1e-9, 1]}}]",
      "bodies.lower.fixed=[{box: {min: [-1, -1, -1], max: [1, 1e-9, 1]}}]",
      "bodies.upper.loads=[{box: {min: [-1, 0.0999, -1], max: [1, 1, 1]}, force: [0, 0, -2]}]",
      NULL};
  double bending = 2e11 * 8e-9 / 12 / 2, edge = 0.1 / 33 / 2, spread = cbrt(1.5 * 0.1 * edge * edge);
  SceneRun run;
  FemCompliance choice;
  for (int k = 0; k < 2; k++) {
    choose(&run, "../../examples/validation/leaves", k ? TURNED : NULL, &choice);
    ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_LEAVES);
    ck_assert_near(choice.stiffness[1], 2 * bending / pow(spread, 4), 0.1 * choice.stiffness[1]);
    forget(&run, &choice);
  }
}
END_TEST

// Two sheets that a driven face, a moved obstacle or a large load squeezes, and two short blocks.
START_TEST(leaves_that_are_squeezed_are_pressed_by_their_heights) {
  static const char *const FACE[] = {"bodies.upper.fixed=null",
                                     "bodies.upper.driven=[{box: {min: [-1, -1, 0.0039], max: [1, 1, 1]}, "
                                     "components: [z], formula: {z: -1e-5*t}}]",
                                     NULL};
  static const char *const PUNCH[] = {"obstacles=[{name: punch, halfspace: {point: [0, 0, 0.005], normal: "
                                      "[0, 0, -1]}, velocity: [0, 0, -1e-3]}]",
                                      NULL};
  static const char *const LOAD[] = {"bodies.upper.loads[0].force=[0, 0, -2e3]", NULL};
  static const char *const SHORT[] = {"bodies.upper.loads=null",
                                      "bodies.upper.mesh.box.size=[0.018, 0.002, 0.002]", NULL};
  const char *const *const changes[] = {FACE, PUNCH, LOAD, SHORT};
  SceneRun run;
  FemCompliance choice;
  for (int k = 0; k < 4; k++) {
    choose(&run, "../../examples/validation/leaves", changes[k], &choice);
    ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_BODIES);
    forget(&run, &choice);
  }
}
END_TEST

START_TEST(quadratic_elements_with_straight_edges_are_named) {
  static const char *const STRAIGHT[] = {"bodies.shaft.element=quadratic", "bodies.ring.element=quadratic",
                                         NULL};
  static const char *const CURVED[] = {"bodies.shaft.element=quadratic", "bodies.ring.element=quadratic",
                                       "bodies.shaft.mesh.curved=true", NULL};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    FemCompliance choice;
    choose(&run, "../../examples/validation/shaft", k ? CURVED : STRAIGHT, &choice);
    ck_assert_int_eq(choice.levels[0], k ? 2 : 0); // facets below straight edges would be bent the wrong way
    ck_assert(choice.is_faceted[0] == (k == 0));
    ck_assert(choice.is_faceted[1]);
    forget(&run, &choice);
  }
}
END_TEST

// One of two equal cubes is driven as a whole; where it is released later, it yields as much as the other.
START_TEST(a_body_that_is_driven_as_a_whole_does_not_yield) {
  SceneRun run;
  FemCompliance choice;
  double stiffness[2];
  for (int k = 0; k < 2; k++) {
    choose(&run, "status",
           k ? (const char *const[]){"time.static=false", "bodies.right.driven[0].release=0.5", NULL}
             : (const char *const[]){"time.static=false", NULL},
           &choice);
    ck_assert(fem_model_is_rigid(&run.model, 1) == (k == 0));
    stiffness[k] = choice.stiffness[1];
    forget(&run, &choice);
  }
  ck_assert_near(stiffness[0], 2 * stiffness[1], 0.02 * stiffness[0]);
}
END_TEST

START_TEST(the_scene_has_the_last_word) {
  SceneRun run;
  FemCompliance choice;
  choose(&run, "../../examples/validation/crossed",
         (const char *const[]){"contact.smooth=2", "contact.stiffness=1e9", NULL}, &choice);
  ck_assert_int_eq(choice.levels[0], 2);
  ck_assert_int_eq(choice.bounds[1], FEM_COMPLIANCE_SCENE);
  ck_assert(choice.stiffness[1] == 1e9);
  forget(&run, &choice);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("compliance");
  tcase_add_test(tests, bodies_of_flat_faces_are_pressed_by_their_heights);
  tcase_add_test(tests, a_shaft_in_a_hole_is_no_stiffer_than_its_elements);
  tcase_add_test(tests, fewer_elements_in_a_patch_are_halved_more);
  tcase_add_test(tests, a_patch_that_nothing_tells_leaves_the_rule_of_the_bodies);
  tcase_add_test(tests, a_torque_tells_no_patch);
  tcase_add_test(tests, a_pressure_tells_its_patch_whether_it_follows_or_not);
  tcase_add_test(tests, a_motion_with_a_short_period_is_seen);
  tcase_add_test(tests, a_short_peak_of_a_table_is_seen);
  tcase_add_test(tests, a_turn_about_an_axis_amid_what_is_driven_is_no_approach);
  tcase_add_test(tests, a_shaft_beside_a_hole_of_its_radius_lies_in_no_hollow);
  tcase_add_test(tests, a_body_that_is_driven_as_a_whole_does_not_yield);
  tcase_add_test(tests, the_choice_knows_no_lengths_and_no_directions);
  tcase_add_test(tests, leaves_that_bend_together_are_no_stiffer_than_their_elements);
  tcase_add_test(tests, leaves_that_are_squeezed_are_pressed_by_their_heights);
  tcase_add_test(tests, quadratic_elements_with_straight_edges_are_named);
  tcase_add_test(tests, the_scene_has_the_last_word);
  return suite_run("compliance", tests, 60);
}
