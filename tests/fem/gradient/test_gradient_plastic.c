// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients with plasticity against central differences of replays with the same steps.
#include "replays.h"

#define LOWER "bodies.lower.material."
#define UPPER "bodies.upper.material."

START_TEST(blocks_that_yield_under_friction_agree_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_yield",
                       .setting = "time.end=1",
                       .least_steps = 7,
                       .least_switches = 10,
                       .least_yields = 50,
                       .of = {"displacement:lower:x", "force:upper:lower:x", "reaction:upper:driven[0]:y",
                              "reaction:lower:fixed[0]:z@0.7", "energy:elastic"},
                       .by = {LOWER "young", LOWER "poisson", LOWER "plasticity.yield",
                              LOWER "plasticity.hardening", UPPER "young", UPPER "plasticity.yield",
                              "bodies.upper.driven[0].table[2][1]", "bodies.upper.place.translate[1]",
                              "contact.friction", "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

// Points that begin to yield within a difference make kinks, so that it is short.
START_TEST(a_block_that_yields_as_it_strikes_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_motion",
                       .setting = UPPER "plasticity={yield: 1.5e3, hardening: 2e4}",
                       .overlap = "time.end=0.04",
                       .step = 1e-5,
                       .least_yields = 10,
                       .of = {"position:upper:3:x", "position:upper:3:z", "energy", "energy:elastic@0.02"},
                       .by = {UPPER "young", UPPER "poisson", UPPER "plasticity.yield",
                              UPPER "plasticity.hardening", UPPER "density", "bodies.upper.velocity[2]",
                              "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_damped_block_that_slides_and_yields_agrees_with_differences_of_replays) {
  const Asked asked = {.scene = "gradient_damped",
                       .setting = UPPER "plasticity={yield: 1e3, hardening: 2e4}",
                       .overlap = "contact.friction=0.3",
                       .least_yields = 10,
                       .of = {"displacement:upper:z", "position:upper:3:x", "energy:elastic"},
                       .by = {UPPER "young", UPPER "plasticity.yield", UPPER "plasticity.hardening",
                              UPPER "viscosity", "contact.friction"}};
  check_against_replays(&asked);
}
END_TEST

static void check_segments(const Asked *asked) {
  FemReplaySteps steps;
  Answer whole, cut;
  find_steps(asked, &steps);
  replay(asked, &steps, NULL, true, &whole);
  steps.most = steps.bytes / 2;
  ck_assert_int_gt(fem_replay_steps_plan(&steps).segment_count, 1);
  replay(asked, &steps, NULL, true, &cut);
  ck_assert(whole.gradient.derivatives[0] != 0);
  ck_assert(whole.gradient.derivatives[0] == cut.gradient.derivatives[0]);
  ck_assert_int_gt(whole.gradient.yields, 0);
  ck_assert_int_eq(whole.gradient.yields, cut.gradient.yields);
  destroy(&whole);
  destroy(&cut);
  fem_replay_steps_destroy(&steps);
}

// Segments that are done again yield the same.
START_TEST(segments_of_a_block_that_yields_give_the_same_gradient) {
  check_segments(&(const Asked){.scene = "gradient_motion",
                                .setting = UPPER "plasticity={yield: 1e3, hardening: 2e4}",
                                .of = {"displacement:upper:z"},
                                .by = {UPPER "plasticity.yield"}});
}
END_TEST

// Friction couples more vertices in the matrix than there are at first.
START_TEST(segments_of_a_damped_block_that_slides_and_yields_give_the_same_gradient) {
  check_segments(&(const Asked){.scene = "gradient_damped",
                                .setting = UPPER "plasticity={yield: 1e3, hardening: 2e4}",
                                .overlap = "contact.friction=0.3",
                                .of = {"energy"},
                                .by = {UPPER "young"}});
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_plastic");
  tcase_add_test(test_case, blocks_that_yield_under_friction_agree_with_differences_of_replays);
  tcase_add_test(test_case, a_block_that_yields_as_it_strikes_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_damped_block_that_slides_and_yields_agrees_with_differences_of_replays);
  tcase_add_test(test_case, segments_of_a_block_that_yields_give_the_same_gradient);
  tcase_add_test(test_case, segments_of_a_damped_block_that_slides_and_yields_give_the_same_gradient);
  return suite_run("gradient_plastic", test_case, 300);
}
