// SPDX-License-Identifier: GPL-3.0-or-later
// What is reported at the end of a run, at the edges of its promises: kept just so, and just broken.
#include "scene.h"

#include <string.h>

#include "fem/effect/contact/contact.h"
#include "fem/run/run_stage.h"

// The trouble of a run of a block in the air with these results.
static const char *told(double momentum_gap, long long beyond) {
  static char text[1024];
  SceneRun run;
  scene_open(&run, "free_fall", NULL);
  FemRunResult result = {.momentum.gap = momentum_gap};
  result.contact.pairs.tried = 100, result.contact.pairs.beyond = beyond;
  fem_run_describe_trouble(&result, &run.model, text, sizeof text);
  scene_close(&run);
  return text;
}

START_TEST(a_gap_of_momentum_of_a_thousandth_is_kept_and_more_is_trouble) {
  ck_assert_str_eq(told(1e-3, 0), "none");
  ck_assert_ptr_nonnull(strstr(told(1e-3 * (1 + 1e-6), 0), "forces and motion differ"));
  ck_assert_ptr_nonnull(strstr(told(NAN, 0), "forces and motion differ"));
}
END_TEST

START_TEST(of_a_hundred_pairs_one_may_be_beyond_the_training) {
  ck_assert_str_eq(told(0, 1), "none");
  ck_assert_ptr_nonnull(strstr(told(0, 2), "pairs beyond the network's training"));
}
END_TEST

// Of the time in which a wave crosses an element.
START_TEST(nothing_moves_in_a_four_hundredth_of_an_elements_crossing) {
  SceneRun run;
  scene_open(&run, "free_fall", NULL);
  double crossing = run.model.edge / fem_model_fastest_wave(&run.model);
  ck_assert_near(fem_run_stage_resolved(&run.model), crossing / 400, 1e-12 * crossing);
  scene_close(&run);
}
END_TEST

// E = 1e6 Pa and ρ = 1000 kg/m³ against a half-space, or the lighter body of two with ρ = 1000 kg/m³. A
// linear contact presses with c d, of two bodies with 2 c d; a law is taken where it presses with E: p = 1e6
// (d/1e-6 m)² at 1e-6 m, where p′ = 2e12 Pa/m; `nodal` has a modulus [Pa].
START_TEST(a_contact_throws_an_element_back_as_a_wave_of_its_modulus_would) {
  const struct {
    const char *scene, *contact;
    double slope, modulus; // [Pa/m], [Pa]
  } cases[] = {
      {"drop", "contact={stiffness: 1e10}", 1e10, 0},
      {"drop", "contact={stiffness: 1}", 0, 1e6},
      {"drop", "contact={law: {power: {pressure: 1e6, depth: 1e-6, exponent: 2}}}", 2e12, 0},
      {"drop", "contact={potential: nodal, stiffness: 1e9}", 0, 1e9},
      {"collision", "contact={stiffness: 1e10}", 2e10, 0},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    SceneRun run;
    scene_open(&run, cases[k].scene, (const char *const[]){cases[k].contact, NULL});
    FemSystem system;
    ck_assert_ok(fem_system_create(&system, &run.model));
    void *contact = fem_system_effect(&system, &fem_effect_contact);
    const ContactLayout *layout = contact_system_layout(fem_effect_contact_system(contact));
    double edge = run.model.edge, speed = sqrt(fmax(cases[k].modulus, cases[k].slope * edge) / 1000),
           expected = edge / speed / 400;
    ck_assert_near(fem_run_stage_rebound(&run.model, layout), expected, 1e-9 * expected);
    fem_system_destroy(&system);
    scene_close(&run);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("result");
  tcase_add_test(cases, a_gap_of_momentum_of_a_thousandth_is_kept_and_more_is_trouble);
  tcase_add_test(cases, of_a_hundred_pairs_one_may_be_beyond_the_training);
  tcase_add_test(cases, nothing_moves_in_a_four_hundredth_of_an_elements_crossing);
  tcase_add_test(cases, a_contact_throws_an_element_back_as_a_wave_of_its_modulus_would);
  return suite_run("result", cases, 20);
}
