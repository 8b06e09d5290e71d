// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of motions by the place and the shape of bodies against central differences of replays with the
// same steps.
#include "folder.h"
#include "replays.h"

#define UPPER "bodies.upper."
#define LOWER "bodies.lower."

// Masses, loads, weight, what is driven and the depth below both surfaces follow the shape.
START_TEST(thrown_and_shaken_blocks_agree_by_scale_and_place_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "time.end=0.03",
      .step = 1e-6,
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:z", "energy"},
      .by = {UPPER "place.scale", LOWER "place.scale", UPPER "place.translate[2]"}};
  check_against_replays(&asked);
}
END_TEST

// The spin's velocities and the middle of mass follow.
START_TEST(a_spinning_block_of_two_materials_agrees_by_scale_and_rotation_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_motion",
      .setting = "bodies.upper.materials=[{halfspace: {point: [0.09, 0, 0], normal: [-1, 0, 0]}, young: 3e5, "
                 "poisson: 0.3, density: 2000}]",
      .overlap =
          "bodies.upper={name: upper, mesh: {box: {size: [0.12, 0.11, 0.1], cells: [2, 1, 1]}}, velocity: "
          "[0.1, 0, -0.4], spin: [1, -2, 3], place: {scale: [1.1, 0.9, 1], rotate: {axis: [1, 2, 3], "
          "degrees: 4}, translate: [0.03, 0.04, 0.106]}, material: {law: stvk, young: 2e5, poisson: 0.2, "
          "density: 1200}}",
      .of = {"displacement:upper:x", "position:upper:3:x"},
      .by = {UPPER "place.scale[0]", UPPER "place.scale[2]", UPPER "place.rotate.degrees"}};
  check_against_replays(&asked);
}
END_TEST

START_TEST(damped_quadratic_blocks_agree_by_scale_with_differences_of_replays) {
  const Asked asked = {
      .scene = "gradient_damped",
      .setting = "time.end=0.02",
      .step = 1e-6,
      .of = {"displacement:upper:z", "position:upper:3:x", "reaction:lower:driven[0]:x", "energy"},
      .by = {UPPER "place.scale", LOWER "place.scale"}};
  check_against_replays(&asked);
}
END_TEST

// dg/dt = Σ dg/dX of a shift and dg/ds = Σ dg/dX · ∂X/∂s of a factor, X = t + s X₀.
START_TEST(derivatives_by_rest_positions_sum_to_those_by_place_and_scale) {
  enum { KEYS = 24 };
  static const double translate[3] = {0.03, 0.04, 0.0995};
  static const char *const of[] = {"position:upper:3:x", "force:upper:lower:z"};
  const Asked whole = {.scene = "gradient_slide",
                       .setting = "time.end=0.01",
                       .overlap = "bodies.upper.mesh.box.cells=1",
                       .of = {of[0], of[1]},
                       .by = {UPPER "place.scale", UPPER "place.translate[0]", UPPER "place.translate[2]"}};
  Asked asked = whole;
  FemReplaySteps steps;
  Answer answer;
  char keys[KEYS][64];
  double sums[2][3] = {{0}};
  find_steps(&whole, &steps);
  for (int begin = 0; begin < KEYS; begin += 12) {
    for (int k = 0; k < 12; k++) {
      snprintf(keys[begin + k], sizeof keys[0], UPPER "rest[%d][%d]", (begin + k) / 3, (begin + k) % 3);
      asked.by[k] = keys[begin + k];
    }
    replay(&asked, &steps, NULL, true, &answer);
    for (int i = 0; i < 24; i++) {
      int c = i % 3;
      double derivative = answer.gradient.derivatives[i];
      sums[i / 12][0] += derivative * (answer.values[i % 12] - translate[c]);
      if (c != 1) sums[i / 12][1 + c / 2] += derivative;
    }
    destroy(&answer);
  }
  replay(&whole, &steps, NULL, true, &answer);
  for (int i = 0; i < 6; i++) {
    double found = answer.gradient.derivatives[i], size = fabs(answer.gradient.values[i / 3]);
    ck_assert_double_ne(found, 0);
    ck_assert_msg(fabs(sums[i / 3][i % 3] - found) <= 1e-6 * fmax(size, fabs(found)),
                  "%s by %s: %.12g, summed %.12g", of[i / 3], whole.by[i % 3], found, sums[i / 3][i % 3]);
  }
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_shape_motion");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, thrown_and_shaken_blocks_agree_by_scale_and_place_with_differences_of_replays);
  tcase_add_test(test_case,
                 a_spinning_block_of_two_materials_agrees_by_scale_and_rotation_with_differences_of_replays);
  tcase_add_test(test_case, derivatives_by_rest_positions_sum_to_those_by_place_and_scale);
  tcase_add_test(test_case, damped_quadratic_blocks_agree_by_scale_with_differences_of_replays);
  return suite_run("gradient_shape_motion", test_case, 300);
}
