// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients with friction against central differences of replays with the same steps.
#include "replays.h"
#include "weights.h"

START_TEST(a_block_that_is_rubbed_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_rub",
                       .setting = "time.end=1",
                       .least_steps = 7,
                       .least_switches = 20,
                       .of = {"displacement:lower:x", "probe:top:x", "force:upper:lower:x", "pressure:top",
                              "patch:top:x", "reaction:upper:driven[0]:y", "energy",
                              "force:upper:lower:x@0.6"},
                       .by = {"bodies.lower.material.young", "bodies.upper.material.poisson",
                              "contact.friction", "contact.stiffness", "bodies.upper.driven[0].table[2][1]",
                              "bodies.upper.driven[0].table[1][3]", "bodies.upper.place.translate[1]"}};
  check_against_replays(&asked);
}
END_TEST

static const char *const learned[] = {"contact.overlap=geo-small", "contact.overlap=hybrid"};

START_TEST(a_block_that_is_rubbed_by_learned_overlaps_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_rub",
                       .setting = "time.end=1",
                       .overlap = learned[_i],
                       .least_steps = 7,
                       .least_switches = 20,
                       .of = {"probe:top:x", "force:upper:lower:x", "reaction:upper:driven[0]:y", "peak:top"},
                       .by = {"bodies.lower.material.young", "contact.friction", "contact.stiffness",
                              "bodies.upper.driven[0].table[1][3]", "bodies.upper.place.translate[1]"}};
  check_against_replays(&asked);
}
END_TEST

// By weights, through all steps.
static void check_weights(const char *model, const char *scene, const char *setting, const char *of) {
  char overlap[400];
  Weights weights = weights_open(model);
  Asked asked = {.scene = scene, .setting = setting, .overlap = overlap, .of = {of}, .by_weights = true};
  FemReplaySteps steps;
  Answer answer, moved;
  double found = 0;
  weights_write(&weights, 0, overlap);
  find_steps(&asked, &steps);
  replay(&asked, &steps, NULL, true, &answer);
  for (int k = 0; k < WEIGHTS_PLACES; k++) {
    weights_write(&weights, weights_places[k], overlap);
    replay(&asked, &steps, NULL, false, &moved);
    found += weights_factors[k] / weights_step * moved.gradient.values[0];
    destroy(&moved);
  }
  double along = weights_along(&weights, answer.gradient.weights);
  ck_assert_double_gt(fabs(along), 0); // they meet
  ck_assert_msg(fabs(along - found) <= 1e-5 * fabs(along), "%s: along %.12g, replays %.12g, g = %.6g", of,
                along, found, answer.gradient.values[0]);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
  weights_close(&weights);
}

static const char *const by_weights[] = {"geo-small", "hybrid"};

START_TEST(slopes_by_weights_agree_with_differences_of_replays) {
  const char *model = by_weights[_i];
  check_weights(model, "gradient_rub", "time.end=1", "force:upper:lower:x");
  check_weights(model, "gradient_rub", "time.end=1", "peak:top");
  check_weights(model, "gradient_motion", "time.end=0.06", "displacement:upper:z");
  check_weights(model, "gradient_slide", "time.end=0.02", "displacement:upper:x");
}
END_TEST

START_TEST(a_slab_between_obstacles_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_drag",
                       .setting = "time.end=1",
                       .least_steps = 6,
                       .least_switches = 20,
                       .of = {"displacement:slab:y", "force:slab:block:x", "force:floor:slab:y",
                              "moment:slab:block:z", "reaction:slab:fixed[0]:y"},
                       .by = {"bodies.slab.material.young", "contact.friction", "contact.pairs[0].friction",
                              "contact.pairs[0].stiffness", "obstacles.block.motion.table[2][2]",
                              "obstacles.floor.motion.velocity[1]", "obstacles.block.box.centre[1]",
                              "bodies.slab.loads[0].traction[1]"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_slab_under_a_rolling_cylinder_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_roll",
      .setting = "time.end=1",
      .tolerance = 1e-6,
      .least_steps = 6,
      .least_switches = 15,
      .of = {"displacement:slab:x", "force:roll:slab:x", "moment:roll:y", "reaction:slab:fixed[0]:z"},
      .by = {"bodies.slab.material.young", "contact.friction", "contact.stiffness",
             "obstacles.roll.motion.table[2][1]", "obstacles.roll.cylinder.centre[2]"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_slab_on_a_plate_of_tetrahedra_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_plate",
      .setting = "time.end=1",
      .tolerance = 1e-6,
      .least_steps = 6,
      .least_switches = 19,
      .of = {"displacement:slab:x", "force:slab:plate:y", "moment:slab:plate:z", "reaction:slab:fixed[0]:x"},
      .by = {"bodies.slab.material.young", "contact.friction", "contact.stiffness",
             "obstacles.plate.motion.table[1][2]", "obstacles.plate.place.translate[2]"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_body_that_rubs_on_itself_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_clamp",
      .setting = "time.end=1",
      .least_steps = 6,
      .least_switches = 20,
      .of = {"displacement:clamp:x", "position:clamp:20:y", "reaction:clamp:driven[0]:x", "energy"},
      .by = {"bodies.clamp.material.young", "bodies.clamp.material.poisson", "contact.friction",
             "contact.stiffness", "bodies.clamp.driven[0].table[2][1]",
             "bodies.clamp.driven[0].table[1][3]"}};
  check_against_replays(&asked);
}
END_TEST

// At its rim a pressure that follows the surface has a matrix that is not symmetric.
START_TEST(bodies_under_following_pressures_agree_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_inflate",
                       .setting = "time.end=1",
                       .least_steps = 4,
                       .of = {"displacement:block:x", "position:block:12:z", "reaction:block:fixed[0]:z"},
                       .by = {"bodies.block.material.young", "bodies.block.loads[0].pressure",
                              "bodies.block.loads[1].pressure"}};
  const Asked plate = {
      .scene = "gradient_inflate",
      .setting = "time.end=1",
      .least_steps = 4,
      .of = {"displacement:plate:z", "displacement:plate:x@0.75", "reaction:plate:fixed[0]:x"},
      .by = {"bodies.plate.material.poisson", "bodies.plate.loads[0].pressure"}};
  check_against_replays(&asked);
  check_against_replays(&plate);
}
END_TEST

// Where it ends in contact, pairs that begin to overlap within a difference make kinks in the force.
START_TEST(a_block_that_sticks_and_slips_in_motion_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_slide",
                       .setting = "time.end=0.03",
                       .tolerance = 3e-6,
                       .step = 1e-5,
                       .least_switches = 10,
                       .of = {"displacement:upper:x", "position:upper:3:z", "force:upper:lower:x",
                              "moment:upper:lower:y", "reaction:lower:driven[0]:x"},
                       .by = {"bodies.upper.material.density", "bodies.upper.velocity[0]", "contact.friction",
                              "bodies.lower.driven[0].amplitude[0]"}};
  check_against_replays(&asked);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_friction");
  tcase_add_test(test_case, a_block_that_is_rubbed_agrees_with_differences_of_replays);
  tcase_add_loop_test(test_case,
                      a_block_that_is_rubbed_by_learned_overlaps_agrees_with_differences_of_replays, 0, 2);
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_loop_test(test_case, slopes_by_weights_agree_with_differences_of_replays, 0, 2);
  tcase_add_test(test_case, a_slab_between_obstacles_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_slab_under_a_rolling_cylinder_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_slab_on_a_plate_of_tetrahedra_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_body_that_rubs_on_itself_agrees_with_differences_of_replays);
  tcase_add_test(test_case, bodies_under_following_pressures_agree_with_differences_of_replays);
  tcase_add_test(test_case, a_block_that_sticks_and_slips_in_motion_agrees_with_differences_of_replays);
  return suite_run("gradient_friction", test_case, 600);
}
