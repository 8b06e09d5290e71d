// SPDX-License-Identifier: GPL-3.0-or-later
// Area of contact and centre of pressure of each two that press each other.
#include "scene.h"

#include "fem/effect/contact/contact.h"

typedef struct Pressed {
  SceneRun run;
  FemSystem system;
  const ContactInterface *interfaces;
  double areas[1]; // of contact
  int count;
} Pressed;

// The scene's first state, with both evaluated.
static void press(Pressed *pressed, const char *scene, const char *const *overrides) {
  scene_open(&pressed->run, scene, overrides);
  const FemModel *model = &pressed->run.model;
  ck_assert_ok(fem_system_create(&pressed->system, model));
  ck_assert_ok(fem_system_forces(&pressed->system, &pressed->system.accepted));
  const ContactEvaluation *evaluation;
  ck_assert_ok(fem_effect_contact_evaluate(&pressed->system, &pressed->system.accepted, &evaluation));
  pressed->interfaces = evaluation->interfaces;
  void *effect = fem_system_effect(&pressed->system, &fem_effect_contact);
  ContactSystem *contact = fem_effect_contact_system(effect);
  pressed->count = contact_system_layout(contact)->interface_count;
  ck_assert_int_eq(pressed->count, 1);
  contact_system_areas(contact, evaluation, pressed->areas);
}

static void release(Pressed *pressed) {
  fem_system_destroy(&pressed->system);
  scene_close(&pressed->run);
}

// A block of 0.05 × 0.05 m², off the middle of a larger one that it overlaps by 0.1 mm.
static void expect_patch(const char *potential, double tolerance, double off) {
  char law[64];
  snprintf(law, sizeof law, "contact.potential=%s", potential);
  const char *const overrides[] = {law,
                                   "contact.stiffness=1e7",
                                   "time.static=false",
                                   "bodies.upper.mesh={box: {size: [0.05, 0.05, 0.05], cells: [5, 5, 5]}}",
                                   "bodies.upper.place={translate: [0.01, 0.03, 0.0499]}",
                                   "bodies.upper.loads=[]",
                                   NULL};
  Pressed pressed;
  press(&pressed, "patch", overrides);
  const ContactInterface *interface = &pressed.interfaces[0];
  ck_assert_double_gt(fabs(interface->force[2]), 0);
  ck_assert_near(pressed.areas[0], 0.0025, tolerance * 0.0025);
  ck_assert_near(interface->centre[0], 0.035, off * 0.05);
  ck_assert_near(interface->centre[1], 0.055, off * 0.05);
  ck_assert_near(interface->centre[2], 0.04995, 1e-3);
  release(&pressed);
}

// The rim of the upper block, where its sides take over, is d wide: 4 · 0.05 · 1e-4 of 0.0025 are 0.8 %, also
// for `nodal`, whose pairs there press sideways.
START_TEST(the_area_of_a_flat_patch_is_that_of_the_smaller_face) {
  expect_patch("field", 0.02, 0.01);
  expect_patch("nodal", 0.01, 0.05);
}
END_TEST

START_TEST(on_an_obstacle_without_a_mesh_the_same) {
  Pressed pressed;
  press(&pressed, "drop", (const char *const[]){"bodies[0].place={translate: [0.3, 0, -1e-4]}", NULL});
  ck_assert_near(pressed.areas[0], 0.04, 1e-9 * 0.04);
  ck_assert_near(pressed.interfaces[0].centre[0], 0.4, 1e-9);
  ck_assert_near(pressed.interfaces[0].centre[1], 0.1, 1e-9);
  release(&pressed);
}
END_TEST

// Turned by 1° about a middle line of the face, so that half of it has sunk in and the depth falls to 0
// there: the rim passes through elements. A sunk side counts with its sine. Of two bodies it takes over
// 0.4 mm of the lower one's share.
START_TEST(the_area_reaches_to_the_rim) {
  const double sine = 0.0174524, cosine = 0.9998477;
  Pressed pressed;
  char place[128];
  snprintf(place, sizeof place,
           "bodies[0].place={rotate: {axis: [0, 1, 0], degrees: 1}, translate: [0, 0, %.9f]}", 0.09 * sine);
  press(&pressed, "drop", (const char *const[]){place, NULL});
  ck_assert_near(pressed.areas[0], 0.11 * 0.2 * (cosine + sine * sine), 1e-6 * 0.04);
  release(&pressed);
  snprintf(place, sizeof place,
           "bodies.upper.place={rotate: {axis: [0, 1, 0], degrees: 1}, translate: [0.02, 0.03, %.9f]}",
           0.05 + 0.025 * sine);
  press(&pressed, "patch",
        (const char *const[]){"time.static=false", "bodies.upper.loads=[]", "bodies.upper.fixed=[]",
                              "bodies.upper.mesh.box.size=[0.05,0.05,0.05]", place, NULL});
  ck_assert_near(pressed.areas[0], 0.025 * 0.05, 0.015 * 0.025 * 0.05);
  release(&pressed);
}
END_TEST

// A ball, and a cylinder on its side, that reach 2 mm into the face of a block whose elements are as wide as
// the patch: chords of √(2 R d − d²).
START_TEST(what_is_round_presses_a_disc_or_a_strip) {
  const double half = sqrt(2 * 0.1 * 0.002 - 0.002 * 0.002);
  Pressed pressed;
  press(&pressed, "drop",
        (const char *const[]){"bodies[0].place={translate: [0, 0, 0]}",
                              "obstacles=[{name: ball, sphere: {centre: [0.09, 0.1, -0.098], radius: 0.1}}]",
                              NULL});
  ck_assert_near(pressed.areas[0], M_PI * half * half, 0.01 * M_PI * half * half);
  release(&pressed);
  press(&pressed, "drop",
        (const char *const[]){"bodies[0].place={translate: [0, 0, 0]}",
                              "obstacles=[{name: roller, cylinder: {centre: [0.09, 0.1, -0.098], axis: [0, "
                              "1, 0], radius: 0.1, length: 1}}]",
                              NULL});
  ck_assert_near(pressed.areas[0], 2 * half * 0.2, 0.01 * 2 * half * 0.2);
  release(&pressed);
}
END_TEST

START_TEST(where_nothing_presses_there_is_no_centre) {
  Pressed pressed;
  press(&pressed, "drop", (const char *const[]){"bodies[0].place={translate: [0, 0, 0.1]}", NULL});
  ck_assert_double_eq(pressed.areas[0], 0);
  for (int c = 0; c < 3; c++) ck_assert(isnan(pressed.interfaces[0].centre[c]));
  release(&pressed);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("imprint");
  tcase_add_test(cases, the_area_of_a_flat_patch_is_that_of_the_smaller_face);
  tcase_add_test(cases, on_an_obstacle_without_a_mesh_the_same);
  tcase_add_test(cases, the_area_reaches_to_the_rim);
  tcase_add_test(cases, what_is_round_presses_a_disc_or_a_strip);
  tcase_add_test(cases, where_nothing_presses_there_is_no_centre);
  return suite_run("imprint", cases, 30);
}
