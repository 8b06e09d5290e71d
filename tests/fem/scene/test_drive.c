// SPDX-License-Identifier: GPL-3.0-or-later
// Prescribed turns by formula and table, beside displacements: closed forms, rates against differences, where
// steps end, and a body that is pressed and then twisted.
#include "static_solve.h"

#include "fem/scene/drive.h"

static const double SHUT = 0.25; // pressed so deep
static double press[] = {0, 0, 0, 0, 1, 0, 0, -0.25};
static double twist[] = {1, 0, 2, M_PI / 2};

// Pressed along z until 1 s, then turned by a quarter about z through (1, 0, 0) until 2 s.
static FemConstraintDef press_and_twist(bool moves_first) {
  return (FemConstraintDef){.table = press,
                            .table_count = 2,
                            .turns = true,
                            .angles = twist,
                            .angle_count = 2,
                            .axis = {0, 0, 2},
                            .centre = {1, 0, 0},
                            .moves_first = moves_first,
                            .until = INFINITY};
}

static void expect_at(const FemConstraintDef *def, double time, double x, double y, double z) {
  double position[3], velocity[3];
  fem_drive_point(def, time, (const double[]){2, 0, 0}, position, velocity);
  ck_assert_near(position[0], x, 1e-15);
  ck_assert_near(position[1], y, 1e-15);
  ck_assert_near(position[2], z, 1e-15);
}

START_TEST(what_is_pressed_is_then_twisted) {
  for (int order = 0; order < 2; order++) {
    FemConstraintDef def = press_and_twist(order);
    expect_at(&def, 0, 2, 0, 0);
    expect_at(&def, 0.5, 2, 0, -SHUT / 2);
    expect_at(&def, 1, 2, 0, -SHUT);
    expect_at(&def, 1.5, 1 + sqrt(0.5), sqrt(0.5), -SHUT);
    expect_at(&def, 2, 1, 1, -SHUT);
    expect_at(&def, 9, 1, 1, -SHUT);
  }
}
END_TEST

// Moved by 3 along x, and turned by a quarter about z through the origin: the displacement turns or not.
START_TEST(the_order_of_a_turn_and_a_displacement_is_told) {
  static double shift[] = {0, 3, 0, 0};
  FemConstraintDef def = press_and_twist(false);
  def.table = shift, def.table_count = 1, def.centre[0] = 0;
  expect_at(&def, 2, 3, 2, 0);
  def.moves_first = true;
  expect_at(&def, 2, 0, 5, 0);
}
END_TEST

// Central differences over 2e-6 s of sines and cosines of a few rad/s are off by 1e-11 of their third
// derivative, and by rounding, 1e-10.
START_TEST(velocities_are_the_rates_of_positions) {
  Expression angle, along;
  ck_assert_ok(expression_parse(&angle, "t", "sin(3*t)"));
  ck_assert_ok(expression_parse(&along, "t", "t^2"));
  for (int order = 0; order < 2; order++) {
    FemConstraintDef def = {.turns = true,
                            .angle = &angle,
                            .axis = {1, 2, -1},
                            .centre = {0.5, 0, 1},
                            .formula = {&along},
                            .moves_first = order,
                            .until = INFINITY};
    const double rest[3] = {2, -1, 3}, h = 1e-6;
    for (double t = 0.1; t < 2; t += 0.3) {
      double before[3], here[3], after[3], velocity[3], unused[3];
      fem_drive_point(&def, t, rest, here, velocity);
      fem_drive_point(&def, t - h, rest, before, unused);
      fem_drive_point(&def, t + h, rest, after, unused);
      for (int c = 0; c < 3; c++) ck_assert_near(velocity[c], (after[c] - before[c]) / (2 * h), 2e-8);
    }
  }
}
END_TEST

// 1 mm at an arm of 2 m: the kinks of the angle end steps as those of a displacement do.
START_TEST(a_step_ends_at_the_kinks_of_a_turn) {
  static const FemForesight foresight = {.displacement = 1e-3, .velocity = 1e-3, .resolution = 1e-9};
  FemConstraintDef def = press_and_twist(false);
  ck_assert_double_eq(fem_drive_horizon(&def, 2, &foresight, 0.2, 1.9), 1);
  ck_assert_double_eq(fem_drive_horizon(&def, 2, &foresight, 1, 1.9), 1.9);
  ck_assert_double_eq(fem_drive_horizon(&def, 2, &foresight, 1.5, 9), 2);
  ck_assert_double_eq(fem_drive_next_change(&def, 0.3), 0.3);
  ck_assert_double_eq(fem_drive_next_change(&def, 1), 1);
  ck_assert(isinf(fem_drive_next_change(&def, 2)));
  ck_assert(!fem_drive_is_still(&def));
}
END_TEST

// A square shaft that is pressed by 1 % and then twisted by 0.02 rad over its length, its ends' warping held:
// the section away from the ends turns in proportion, and the work of the drive is the strain energy.
START_TEST(a_shaft_is_pressed_and_then_twisted) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 2, static: true}\n"
                        "output: {frames: 4}\n"
                        "bodies:\n"
                        "  - name: shaft\n"
                        "    mesh: {box: {size: [4, 1, 1], cells: [8, 2, 2]}}\n"
                        "    material: {law: corotational, young: 1, poisson: 0.3, density: 1}\n"
                        "    fixed: [{group: x_min}]\n"
                        "    driven: [{group: x_max, table: [[0, 0, 0, 0], [1, -0.04, 0, 0]],\n"
                        "              turn: {axis: [1, 0, 0], centre: [0, 0.5, 0.5], table: [[1, 0], [2, "
                        "0.02]]}}]\n");
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  double pressed = 0, turned = 0, inertia = 0;
  int count = 0;
  for (int v = 0; v < run.model.vertex_count; v++) {
    const double *X = run.model.rest + 3 * v, *half = scene_position(&run, 2, v),
                 *end = scene_position(&run, 4, v);
    if (X[0] != 2) continue;
    pressed += X[0] - half[0], count++;
    turned += (X[1] - 0.5) * (end[2] - half[2]) - (X[2] - 0.5) * (end[1] - half[1]);
    inertia += (X[1] - 0.5) * (X[1] - 0.5) + (X[2] - 0.5) * (X[2] - 0.5);
  }
  ck_assert_int_gt(count, 0);
  ck_assert_near(pressed / count, 0.02, 1e-3); // the mesh's diagonals are not symmetric
  ck_assert_near(turned / inertia, 0.01, 1e-3);
  ck_assert_double_gt(run.result.energy.audit.work, 0.9 * 0.5 * 0.01 * 0.01 * 4); // ½ E ε² V
  ck_assert_near(run.result.energy.audit.total, 0, 1e-2 * run.result.energy.audit.work);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("drive");
  tcase_add_test(test_case, what_is_pressed_is_then_twisted);
  tcase_add_test(test_case, the_order_of_a_turn_and_a_displacement_is_told);
  tcase_add_test(test_case, velocities_are_the_rates_of_positions);
  tcase_add_test(test_case, a_step_ends_at_the_kinks_of_a_turn);
  tcase_add_test(test_case, a_shaft_is_pressed_and_then_twisted);
  return suite_run("drive", test_case, 60);
}
