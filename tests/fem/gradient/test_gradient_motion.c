// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of motions against central differences of replays with the same steps, and what has none.
#include "folder.h"
#include "replays.h"

START_TEST(a_block_thrown_upon_a_shaken_one_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.06",
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:z", "energy"},
      .by = {"bodies.lower.material.young", "bodies.upper.material.density", "bodies.upper.velocity[2]",
             "bodies.lower.driven[0].amplitude[2]", "contact.stiffness", "bodies.upper.loads[0].force[0]"}};
  check_against_replays(&asked);
}
END_TEST

// Pairs of cells that begin to overlap within a difference make kinks in the force.
START_TEST(a_motion_that_ends_in_contact_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.012",
      .tolerance = 1e-5,
      .of = {"force:upper:lower:z", "displacement:upper:z", "energy"},
      .by = {"bodies.lower.material.young", "bodies.upper.velocity[2]", "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

// Of a path, and of a misfit to it, whose terms meet on the way back.
START_TEST(goals_at_earlier_times_agree_with_differences_of_replays) {
  char misfit[256];
  snprintf(misfit, sizeof misfit, "misfit:%s/path.csv", folder);
  FILE *file = fopen(misfit + strlen("misfit:"), "w");
  ck_assert_ptr_nonnull(file);
  fputs("position:upper:3:x@0.02, 1e4, 0.03\nposition:upper:3:x@0.04, 1e4, 0.04\ndisplacement:upper:z, 1e4, "
        "0\n",
        file);
  ck_assert_int_eq(fclose(file), 0);
  const Asked asked = {.scene = "gradient_motion",
                       .setting = "time.end=0.06",
                       .of = {"displacement:upper:z@0.0325", "reaction:lower:driven[0]:z@0.05", misfit},
                       .by = {"bodies.lower.material.young", "bodies.upper.material.density",
                              "bodies.upper.velocity[2]", "bodies.lower.driven[0].amplitude[2]"}};
  check_against_replays(&asked);
}
END_TEST

static const char *const learned[] = {"contact.overlap=geo-small", "contact.overlap=hybrid"};

START_TEST(a_block_thrown_by_learned_overlaps_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.06",
      .overlap = learned[_i],
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:z"},
      .by = {"bodies.lower.material.young", "bodies.upper.velocity[2]", "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_block_of_two_materials_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "bodies.upper.materials=[{halfspace: {point: [0.09, 0, 0], normal: [-1, 0, 0]}, young: 3e5, "
                 "poisson: 0.3, density: 2000}]",
      .of = {"displacement:upper:z", "energy"},
      .by = {"bodies.upper.material.young", "bodies.upper.materials[0].young",
             "bodies.upper.material.density", "bodies.upper.materials[0].density", "contact.stiffness"}};
  check_against_replays(&asked);
}
END_TEST

// The middle of mass, about which it turns, moves by the density of either part.
START_TEST(a_spinning_block_of_two_materials_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "bodies.upper.materials=[{halfspace: {point: [0.09, 0, 0], normal: [-1, 0, 0]}, young: 3e5, "
                 "poisson: 0.3, density: 2000}]",
      .overlap = "bodies.upper.spin=[1, -2, 3]",
      .of = {"displacement:upper:x", "position:upper:3:x"},
      .by = {"bodies.upper.spin[1]", "bodies.upper.spin[2]", "bodies.upper.materials[0].density"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(a_damped_block_thrown_upon_another_agrees_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_damped",
      .setting = "time.end=0.03",
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:x", "energy"},
      .by = {"effects.damping", "bodies.upper.material.damping", "bodies.upper.material.viscosity",
             "bodies.upper.material.bulk_viscosity", "bodies.lower.material.young",
             "bodies.upper.material.density", "bodies.upper.velocity[2]", "bodies.lower.driven[0].spin"}};
  check_against_replays(&asked);
}
END_TEST

static void refuse(const char *override, const char *by, const char *why) {
  SceneRun scene;
  FemParameter parameter;
  FemReplaySteps steps = {0};
  FemGradient gradient = {0};
  scene_open(&scene, "gradient_motion", (const char *const[]){override, NULL});
  Status status = app_gradient_read_parameter(&scene.model, by, &parameter);
  if (!status)
    status = fem_path_differentiate(&gradient, &scene.model,
                                    &(FemGradientDef){NULL, &parameter, 0, 1, false, false}, &steps, NULL);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s: %s", override, status_message());
  fem_gradient_destroy(&gradient);
  scene_close(&scene);
}

START_TEST(motions_without_a_gradient_are_refused_by_name) {
  const char *young = "bodies.upper.material.young";
  refuse("contact.viscosity=1", young, "contact.viscosity");
  refuse("contact.friction={coefficient: 0.2, static: 0.3}", young, "contact.friction.static");
  refuse("contact.rest={speed: 1e-3}", young, "contact.rest");
  refuse("contact={stiffness: 1e7, friction: 0.1, law: {power: {pressure: 1e5, depth: 0.01, exponent: 1.5}}}",
         young, "contact.law");
  refuse("bodies.lower.driven[0].release=0.01", young, "released");
  refuse("time.end=0.06", "bodies.upper.material.damping", "body 'upper' has no such constant of its own");
  refuse("effects.damping=1e-3", "bodies.upper.material.damping", "give it a value");
  refuse("time.end=0.06", "effects.damping", "effects.damping is not given or 0");
  refuse("time.end=0.06", "contact.viscosity", "no derivative by the viscosity of contact");
  refuse("time.end=0.06", young, "made no step");
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_motion");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, a_block_thrown_upon_a_shaken_one_agrees_with_differences_of_replays);
  tcase_add_test(test_case, goals_at_earlier_times_agree_with_differences_of_replays);
  tcase_add_loop_test(test_case, a_block_thrown_by_learned_overlaps_agrees_with_differences_of_replays, 0, 2);
  tcase_add_test(test_case, a_block_of_two_materials_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_spinning_block_of_two_materials_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_motion_that_ends_in_contact_agrees_with_differences_of_replays);
  tcase_add_test(test_case, a_damped_block_thrown_upon_another_agrees_with_differences_of_replays);
  tcase_add_test(test_case, motions_without_a_gradient_are_refused_by_name);
  return suite_run("gradient_motion", test_case, 300);
}
