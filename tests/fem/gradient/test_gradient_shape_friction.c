// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives by the shape of bodies with friction and following pressures against central differences of
// replays with the same steps.
#include "fem/model/compliance/compliance.h"
#include "replays.h"

#define UPPER "bodies.upper.place."
#define LOWER "bodies.lower.place."

START_TEST(rubbed_blocks_agree_by_scale_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_rub",
                       .setting = "time.end=1",
                       .step = 1e-6,
                       .least_steps = 7,
                       .least_switches = 20,
                       .of = {"displacement:lower:x", "probe:top:x", "force:upper:lower:x", "patch:top:x",
                              "reaction:upper:driven[0]:y", "energy", "force:upper:lower:x@0.6"},
                       .by = {UPPER "scale", LOWER "scale"}};
  check_against_replays(&asked);
}
END_TEST

// Of two bodies of one size the first is the slave, which stays where the second one grows.
START_TEST(blocks_of_one_size_agree_by_scale_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_rub",
                       .setting = "time.end=1",
                       .overlap = "bodies.upper.mesh.box.size=[1, 1, 0.5]",
                       .step = 1e-5,
                       .is_forward = true,
                       .least_steps = 7,
                       .least_switches = 20,
                       .of = {"displacement:lower:x", "force:upper:lower:x", "energy"},
                       .by = {UPPER "scale"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_slab_between_obstacles_agrees_by_scale_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_drag",
      .setting = "time.end=1",
      .step = 1e-6,
      .least_steps = 6,
      .least_switches = 20,
      .of = {"displacement:slab:y", "force:slab:block:x", "moment:slab:block:z", "reaction:slab:fixed[0]:y"},
      .by = {"bodies.slab.place.scale"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_thrown_block_that_sticks_and_slips_agrees_by_scale_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_slide",
                       .setting = "time.end=0.02",
                       .step = 1e-6,
                       .least_switches = 1,
                       .tolerance = 1e-5, // pairs that begin to overlap within a difference
                       .of = {"displacement:upper:x", "position:upper:3:y", "force:upper:lower:x"},
                       .by = {UPPER "scale", UPPER "translate[0]"}};
  check_against_replays(&asked);
}
END_TEST

// Of an overlap of 1e-10 m second differences of forces are rounding. Steps and adjoints leave 1e-12 of what
// they solve for, over the overlap's share 1e-9 of the block's height.
START_TEST(a_block_that_barely_touches_agrees_by_scale_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_slide",
      .setting = "time.end=0.0002",
      .overlap = "bodies.upper={name: upper, mesh: {box: {size: [0.12, 0.11, 0.1], cells: [2, 1, 1]}}, "
                 "place: {translate: [0.03, 0.04, 0.0999999999]}, material: {law: stvk, young: 2e5, poisson: "
                 "0.2, density: 1200}}",
      .step = 1e-3,
      .tolerance = 1e-3,
      .least_steps = 10,
      .of = {"force:upper:lower:z"},
      .by = {UPPER "scale"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(bodies_under_following_pressures_agree_by_scale_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_inflate",
      .setting = "time.end=1",
      .least_steps = 4,
      .of = {"displacement:block:z", "displacement:plate:z", "reaction:block:fixed[0]:z", "energy"},
      .by = {"bodies.block.place.scale", "bodies.plate.place.scale"}};
  check_against_replays(&asked);
}
END_TEST

static void differentiate(const char *contact, double derivatives[2]) {
  const Asked asked = {.scene = "gradient_chosen",
                       .setting = contact,
                       .of = {"displacement:upper:z", "force:upper:lower:x"},
                       .by = {UPPER "scale"}};
  FemReplaySteps steps;
  Answer answer;
  find_steps(&asked, &steps);
  replay(&asked, &steps, NULL, true, &answer);
  memcpy(derivatives, answer.gradient.derivatives, 2 * sizeof *derivatives);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}

// The springs of friction follow that stiffness.
START_TEST(a_stiffness_that_is_chosen_is_kept) {
  double chosen[2], given[2];
  SceneRun scene;
  FemCompliance choice;
  char setting[128];
  scene_open(&scene, "gradient_chosen", (const char *const[]){NULL});
  ck_assert_ok(fem_compliance_choose(&scene.model, &choice));
  snprintf(setting, sizeof setting, "contact={stiffness: %.17g, friction: 0.2}", choice.stiffness[1]);
  fem_compliance_destroy(&choice);
  scene_close(&scene);
  differentiate("contact.friction=0.2", chosen);
  differentiate(setting, given);
  for (int g = 0; g < 2; g++) {
    ck_assert_double_ne(chosen[g], 0);
    ck_assert_near(given[g] / chosen[g], 1, 1e-6);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_shape_friction");
  tcase_add_test(test_case, rubbed_blocks_agree_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, blocks_of_one_size_agree_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, a_slab_between_obstacles_agrees_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, a_thrown_block_that_sticks_and_slips_agrees_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, a_block_that_barely_touches_agrees_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, bodies_under_following_pressures_agree_by_scale_with_differences_of_replays);
  tcase_add_test(test_case, a_stiffness_that_is_chosen_is_kept);
  return suite_run("gradient_shape_friction", test_case, 300);
}
