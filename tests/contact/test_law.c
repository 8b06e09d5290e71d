// SPDX-License-Identifier: GPL-3.0-or-later
// Pressure laws of the potential `field`: the laws themselves, energies, forces and stiffness of what presses
// by them, flat surfaces at the pressure that the law gives for their overlap.
#include "pressing.h"

#include <string.h>

#include "contact/pressure/field.h"

static double TABLE[] = {0, 0, 0.02, 10, 0.05, 40, 0.1, 150, 0.4, 1500};

enum { LINE, SQUARE, HERTZ, EXPONENTIAL, ROWS, FORMULA, LAWS };

static ContactLaw law_of(int kind, Expression *formula) {
  switch (kind) {
  case LINE:
    return (ContactLaw){.kind = CONTACT_LAW_POWER, .exponent = 1, .pressure = 100, .depth = 0.05};
  case SQUARE:
    return (ContactLaw){.kind = CONTACT_LAW_POWER, .exponent = 2, .pressure = 100, .depth = 0.05};
  case HERTZ:
    return (ContactLaw){.kind = CONTACT_LAW_POWER, .exponent = 1.5, .pressure = 100, .depth = 0.05};
  case EXPONENTIAL:
    return (ContactLaw){.kind = CONTACT_LAW_EXPONENTIAL, .pressure = 100, .depth = 0.2};
  case ROWS:
    return (ContactLaw){.kind = CONTACT_LAW_TABLE, .table = TABLE, .table_count = 5};
  default:
    ck_assert_ok(expression_parse(formula, "d", "1e3*d + 2e4*d^2"));
    return (ContactLaw){.kind = CONTACT_LAW_FORMULA, .formula = formula};
  }
}

// ---- The laws.

START_TEST(slope_and_curve_are_the_derivatives) {
  Expression formula;
  ContactLaw law = law_of(_i, &formula);
  for (int k = 1; k < 40; k++) {
    double d = 0.0123 * k, h = 1e-6;
    ContactLawValue at = contact_law_at(&law, d), above = contact_law_at(&law, d + h),
                    below = contact_law_at(&law, d - h);
    ck_assert_near(at.slope, (above.pressure - below.pressure) / (2 * h), 1e-7 * at.slope + 1e-6);
    ck_assert_near(at.curve, (above.slope - below.slope) / (2 * h), 1e-6 * fabs(at.curve) + 1e-3);
  }
}
END_TEST

// A law with its constant moved by a share.
static ContactLaw moved_law(const ContactLaw *law, ContactLawBy by, double share, double *value,
                            double table[10]) {
  ContactLaw moved = *law;
  memcpy(table, TABLE, sizeof TABLE);
  moved.table = table;
  double *places[] = {[CONTACT_LAW_BY_PRESSURE] = &moved.pressure,
                      [CONTACT_LAW_BY_DEPTH] = &moved.depth,
                      [CONTACT_LAW_BY_EXPONENT] = &moved.exponent,
                      [CONTACT_LAW_BY_ROW] = &table[2 * law->row + 1]};
  *value = *places[by];
  *places[by] *= 1 + share;
  return moved;
}

// A law by its constant is a law: value, slope and curve are those of a difference.
static void check_by(ContactLaw law, ContactLawBy by, int row) {
  static const double STEP = 1e-5;
  double tables[2][10], value;
  law.row = row;
  ContactLaw above = moved_law(&law, by, STEP, &value, tables[0]);
  ContactLaw below = moved_law(&law, by, -STEP, &value, tables[1]);
  law.by = by;
  for (int k = 1; k < 40; k++) {
    double d = 0.0123 * k, step = 2 * STEP * value;
    ContactLawValue at = contact_law_at(&law, d), up = contact_law_at(&above, d),
                    down = contact_law_at(&below, d);
    ck_assert_near(at.pressure, (up.pressure - down.pressure) / step,
                   1e-8 * (fabs(at.pressure) + up.pressure));
    ck_assert_near(at.slope, (up.slope - down.slope) / step, 1e-8 * (fabs(at.slope) + up.slope));
    ck_assert_near(at.curve, (up.curve - down.curve) / step, 1e-8 * (fabs(at.curve) + fabs(up.curve) + 1e3));
  }
}

START_TEST(a_law_by_its_constant_is_what_differences_say) {
  check_by(law_of(HERTZ, NULL), CONTACT_LAW_BY_PRESSURE, 0);
  check_by(law_of(HERTZ, NULL), CONTACT_LAW_BY_DEPTH, 0);
  check_by(law_of(HERTZ, NULL), CONTACT_LAW_BY_EXPONENT, 0);
  check_by(law_of(SQUARE, NULL), CONTACT_LAW_BY_EXPONENT, 0);
  check_by(law_of(EXPONENTIAL, NULL), CONTACT_LAW_BY_PRESSURE, 0);
  check_by(law_of(EXPONENTIAL, NULL), CONTACT_LAW_BY_DEPTH, 0);
  for (int row = 1; row < 5; row++) check_by(law_of(ROWS, NULL), CONTACT_LAW_BY_ROW, row);
}
END_TEST

START_TEST(a_table_goes_through_its_rows_and_never_falls) {
  Expression formula;
  ContactLaw law = law_of(ROWS, &formula);
  double last = 0;
  for (int k = 0; k < 5; k++)
    ck_assert_near(contact_law_at(&law, TABLE[2 * k]).pressure, TABLE[2 * k + 1], 1e-12 * TABLE[9]);
  for (int k = 0; k <= 1000; k++) {
    ContactLawValue value = contact_law_at(&law, 0.0007 * k);
    ck_assert(value.pressure >= last && value.slope > 0);
    last = value.pressure;
  }
  ContactLawValue beyond = contact_law_at(&law, 0.6); // straight, by the last two rows
  ck_assert_near(beyond.pressure, 1500 + 0.2 * 1350 / 0.3, 1e-9);
}
END_TEST

static void refuse(const ContactLaw *law, const char *expected) {
  char why[256] = "";
  ck_assert(!contact_law_check(law, 1, 1e6, why, sizeof why));
  ck_assert_msg(strstr(why, expected), "%s", why);
}

static void refuse_formula(const char *text, const char *expected) {
  Expression formula;
  ck_assert_ok(expression_parse(&formula, "d", text));
  refuse(&(ContactLaw){.kind = CONTACT_LAW_FORMULA, .formula = &formula}, expected);
}

START_TEST(laws_that_make_no_sense_are_refused) {
  refuse_formula("1e3*d + 5", "it must be 0");
  refuse_formula("1e3*d - 1e4*d^2", "falls");
  refuse_formula("1e3*d/sqrt(0.1 - d)", "finite");
  refuse_formula("log(d)", "it must be 0");
  refuse_formula("0*d", "is 0 up to");
  double falling[] = {0, 0, 0.1, 10, 0.2, 9}, raised[] = {0, 1, 0.1, 10}, single[] = {0, 0};
  refuse(&(ContactLaw){.kind = CONTACT_LAW_TABLE, .table = falling, .table_count = 3}, "row 2");
  refuse(&(ContactLaw){.kind = CONTACT_LAW_TABLE, .table = raised, .table_count = 2}, "[0, 0]");
  refuse(&(ContactLaw){.kind = CONTACT_LAW_TABLE, .table = single, .table_count = 1}, "another");
  for (int kind = 0; kind < LAWS; kind++) {
    Expression formula;
    char why[256] = "";
    ContactLaw law = law_of(kind, &formula);
    ck_assert_msg(contact_law_check(&law, 1, 1e6, why, sizeof why), "%s", why);
  }
}
END_TEST

// ---- Derivatives.

// What the rules that integrate a law leave, over the size of what is compared. Between bodies they are exact
// for p of second degree, else no better than p is even in an overlap of a third of an element, as here.
// Against a plane they are exact for what is a polynomial between two rows, or a power.
static double gradient_error(int kind, int law) {
  bool is_exact = law == LINE || law == SQUARE || law == FORMULA;
  if (kind <= ON_MESH) return is_exact ? 1e-8 : 5e-3;
  return law == LINE || kind == ON_PLANE ? 1e-8 : 5e-4;
}

static double stiffness_error(int kind, int law) {
  bool is_exact = law == LINE || law == SQUARE || law == FORMULA;
  if (kind <= ON_MESH) return is_exact ? 1e-6 : law == EXPONENTIAL ? 0.02 : law == HERTZ ? 0.2 : 0.5;
  return law == LINE || kind == ON_PLANE ? 1e-6 : 0.1;
}

START_TEST(forces_are_minus_the_gradient_of_the_energy) {
  for (int kind = 0; kind < KINDS; kind++) {
    Expression formula;
    ContactLaw law = law_of(_i, &formula);
    Scene scene;
    press_on(&scene, kind);
    scene.law = &law;
    start(&scene, "clip");
    int n = 3 * scene.blocks.vertex_count;
    double *x = blocks_copy(&scene.blocks), *force = forces_at(&scene, scene.blocks.x);
    double size = sqrt(product_dot(force, force, n));
    ck_assert(size > 0);
    double worst = 0;
    for (uint64_t k = 0; k < 10; k++) {
      double *d = random_motion(&scene, k, true), length = sqrt(product_dot(d, d, n));
      worst = suite_larger(worst, fabs(slope_along(&scene, d, 1e-5, x) + product_dot(force, d, n)) /
                                      (size * length));
      free(d);
    }
    ck_assert_double_le(worst, gradient_error(kind, _i));
    free(x), free(force), destroy(&scene);
  }
}
END_TEST

START_TEST(stiffness_is_minus_the_derivative_of_the_forces) {
  for (int kind = 0; kind < KINDS; kind++) {
    Expression formula;
    ContactLaw law = law_of(_i, &formula);
    Scene scene;
    press_on(&scene, kind);
    scene.law = &law;
    start(&scene, "clip");
    int n = 3 * scene.blocks.vertex_count;
    double *x = blocks_copy(&scene.blocks), h = 1e-6, worst = 0;
    for (uint64_t k = 0; k < 5; k++) {
      double *d = random_motion(&scene, k, false);
      double *expected = stiffness_along(&scene, d, h, x);
      Product product = product_of(d, scene.blocks.vertex_count);
      ContactStiffnessSink sink = product_sink(&product);
      ck_assert_ok(
          contact_system_stiffness(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), &sink));
      double size = sqrt(product_dot(product.y, product.y, n)), square = 0;
      for (int i = 0; i < n; i++) {
        int body = i / 3 < scene.blocks.bodies[0].vertex_end ? 0 : 1;
        if (scene.blocks.bodies[body].is_obstacle) continue;
        square += (product.y[i] - expected[i]) * (product.y[i] - expected[i]);
      }
      worst = suite_larger(worst, sqrt(square) / size);
      free(d), free(expected), free(product.y);
    }
    ck_assert_double_le(worst, stiffness_error(kind, _i));
    free(x), destroy(&scene);
  }
}
END_TEST

// −∂f/∂x along d, by the matrix that is not symmetric. Owned by the caller (free).
static double *turned_along(Scene *scene, const double *d) {
  Product product = product_of(d, scene->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  ck_assert_ok(contact_system_turn(scene->system, evaluated_at(scene->system, 0, scene->blocks.x),
                                   CONTACT_ALL_INTERFACES, &sink));
  return product.y;
}

// The same of a scene that lies this far from the origin, along a random direction.
static double *turned_at(const ContactLaw *law, int kind, double far, int *count) {
  static const double GRID = 0x1p-32; // positions are multiples of it here and there
  Scene scene;
  press_on(&scene, kind);
  scene.rest = blocks_copy(&scene.blocks);
  for (int i = 0; i < 3 * scene.blocks.vertex_count; i++) {
    scene.blocks.x[i] = far + GRID * round(scene.blocks.x[i] / GRID);
    scene.rest[i] = far + GRID * round(scene.rest[i] / GRID);
  }
  for (int c = 0; c < 3; c++) scene.shape.point[c] = far + GRID * round(scene.shape.point[c] / GRID);
  scene.law = law;
  start(&scene, "clip");
  double *d = random_motion(&scene, 1, false), *turned = turned_along(&scene, d);
  *count = 3 * scene.blocks.vertex_count;
  free(d), destroy(&scene);
  return turned;
}

// Differences of forces are divided by how far coordinates went, which is rounded to 1e-5 of a step so far
// away. Of shapes that find their forces from differences of positions, so that rounding of those does not
// show.
START_TEST(the_matrix_of_a_law_is_the_same_far_from_the_origin) {
  const int kinds[] = {ON_BALL, ON_PRISM};
  Expression formula;
  ContactLaw law = law_of(SQUARE, &formula);
  int n;
  double *near = turned_at(&law, kinds[_i], 0, &n), *far = turned_at(&law, kinds[_i], 0x1p20, &n);
  double sum = 0, whole = product_dot(near, near, n);
  for (int i = 0; i < n; i++) sum += (far[i] - near[i]) * (far[i] - near[i]);
  ck_assert_double_gt(whole, 0);
  ck_assert_double_le(sqrt(sum / whole), 1e-7);
  free(near), free(far);
}
END_TEST

START_TEST(the_matrix_of_a_law_is_what_differences_say_where_a_body_is_folded) {
  Expression formula;
  ContactLaw law = law_of(SQUARE, &formula);
  Scene scene;
  press_on(&scene, ON_BODY);
  scene.law = &law;
  start(&scene, "clip");
  ck_assert_int_gt(fold(&scene), 10);
  int n = 3 * scene.blocks.vertex_count;
  double *x = blocks_copy(&scene.blocks), *d = random_motion(&scene, 1, false), square = 0;
  double *turned = turned_along(&scene, d), *expected = stiffness_along(&scene, d, 1e-6, x);
  for (int i = 0; i < n; i++) square += (turned[i] - expected[i]) * (turned[i] - expected[i]);
  // Differences by steps of a pair's depth, which is small in some.
  ck_assert_double_le(sqrt(square / product_dot(turned, turned, n)), 1e-5);
  free(x), free(d), free(turned), free(expected), destroy(&scene);
}
END_TEST

// Of the energy along a motion, with force and stiffness: what is left is of third order.
START_TEST(energy_force_and_stiffness_are_a_taylor_series) {
  int kind = _i ? ON_PLANE : ON_BODY;
  Expression formula;
  ContactLaw law = law_of(FORMULA, &formula);
  Scene scene;
  press_on(&scene, kind);
  scene.law = &law;
  start(&scene, "clip");
  int n = 3 * scene.blocks.vertex_count;
  double *x = blocks_copy(&scene.blocks), *d = random_motion(&scene, 3, true), left[2];
  double *force = forces_at(&scene, scene.blocks.x), energy = energy_at(&scene, scene.blocks.x);
  Product product = product_of(d, scene.blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  ck_assert_ok(contact_system_stiffness(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), &sink));
  for (int k = 0; k < 2; k++) {
    double h = 4e-3 / (1 + k);
    step_to(&scene, h, d, x);
    left[k] = energy_at(&scene, x) - energy + h * product_dot(force, d, n) -
              h * h / 2 * product_dot(product.y, d, n);
  }
  ck_assert_double_gt(fabs(left[0] / left[1]), 6); // 8 but for terms of fourth order
  free(x), free(d), free(force), free(product.y), destroy(&scene);
}
END_TEST

START_TEST(every_pair_balances) {
  Expression formula;
  ContactLaw law = law_of(_i, &formula);
  Scene scene;
  press_on(&scene, ON_BODY);
  scene.law = &law;
  start(&scene, _i == ROWS ? "tpn-scene" : "clip");
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.blocks.x);
  const ContactLayout *layout = contact_system_layout(scene.system);
  double worst = 0, largest = 0;
  for (int k = 0; k < evaluation->pair_count; k++) {
    Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
    for (int v = 0; v < 8; v++) {
      int vertex = contact_layout_vertices(layout, evaluation->pairs[k].cells[v / 4])[v % 4];
      Vec3 force = vec3_at(evaluation->pair_forces + 24 * k + 3 * v);
      sum = vec3_add(sum, force);
      torque = vec3_add(torque, vec3_cross(vec3_at(scene.blocks.x + 3 * vertex), force));
      largest = suite_larger(largest, vec3_length(force));
    }
    worst = suite_larger(worst, suite_larger(vec3_length(sum), vec3_length(torque)));
  }
  ck_assert_int_gt(evaluation->pair_count, 50);
  ck_assert_double_gt(largest, 0);
  ck_assert_double_le(worst, 1e-13 * largest);
  destroy(&scene);
}
END_TEST

// ---- Flat surfaces.

// The pressure of a block of 4 × 4 that overlaps by `depth` with a block of another mesh or a floor; `model`
// NULL: with the floor. `area`: as contact tells it.
static double flat_pressure(const ContactLaw *law, double depth, const char *model, double *area) {
  Scene scene = {.law = law};
  if (model)
    blocks_add(&scene.blocks, &(BlockDef){.corner = {0, 0, -2}, .cell = {1, 1, 1}, .cells = {4, 4, 2}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {0, 0, -depth}, .cell = {0.8, 0.8, 0.7}, .cells = {5, 5, 3}});
  scene.shape_count = model ? 0 : 1;
  scene.shape = (ContactShape){.name = "floor", .normal = {0, 0, 1}};
  unsigned char *inner = blocks_mark_sides(&scene.blocks, 4);
  scene.inner = inner;
  start(&scene, model ? model : "clip");
  double *force = forces_at(&scene, scene.blocks.x), total = 0;
  const ContactBody *upper = &scene.blocks.bodies[scene.blocks.body_count - 1];
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++) total += force[3 * v + 2];
  contact_system_areas(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), area);
  free(force), free(inner), destroy(&scene);
  return total / 16;
}

START_TEST(flat_surfaces_press_with_the_law_s_pressure) {
  static const double DEPTHS[] = {0.01, 0.04, 0.1};
  for (int k = 0; k < 3; k++) {
    Expression formula;
    ContactLaw law = law_of(_i, &formula);
    double area, expected = contact_law_at(&law, DEPTHS[k]).pressure;
    bool is_even = _i != HERTZ && _i != ROWS; // else two points of an overlap are off by up to 2 %
    double bound = is_even ? 1e-4 : 0.02;
    ck_assert_near(flat_pressure(&law, DEPTHS[k], "clip", &area) / expected, 1, bound);
    ck_assert_near(area / 16, 1, 1e-9);
    ck_assert_near(flat_pressure(&law, DEPTHS[k], "exact", &area) / expected, 1, bound);
    ck_assert_near(flat_pressure(&law, DEPTHS[k], NULL, &area) / expected, 1, 1e-6);
    ck_assert_near(area / 16, 1, 1e-9);
  }
}
END_TEST

// Lengths in another unit, pressures alike: energies are lengths cubed.
START_TEST(the_unit_of_length_is_of_no_account) {
  double area, unit = 1e-3;
  ContactLaw large = {.kind = CONTACT_LAW_POWER, .exponent = 2.5, .pressure = 7, .depth = 0.02},
             small = large;
  ContactLawValue at = contact_law_at(&large, 0.03);
  small.depth *= unit;
  ContactLawValue scaled = contact_law_at(&small, 0.03 * unit);
  ck_assert_near(scaled.pressure / at.pressure, 1, 1e-13);
  ck_assert_near(scaled.slope * unit / at.slope, 1, 1e-13);
  ck_assert_near(flat_pressure(&large, 0.03, "clip", &area) / at.pressure, 1, 5e-3);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("law");
  tcase_add_loop_test(tests, slope_and_curve_are_the_derivatives, 0, LAWS);
  tcase_add_test(tests, a_law_by_its_constant_is_what_differences_say);
  tcase_add_test(tests, a_table_goes_through_its_rows_and_never_falls);
  tcase_add_test(tests, laws_that_make_no_sense_are_refused);
  tcase_add_loop_test(tests, forces_are_minus_the_gradient_of_the_energy, 0, LAWS);
  tcase_add_loop_test(tests, stiffness_is_minus_the_derivative_of_the_forces, 0, LAWS);
  tcase_add_loop_test(tests, the_matrix_of_a_law_is_the_same_far_from_the_origin, 0, 2);
  tcase_add_test(tests, the_matrix_of_a_law_is_what_differences_say_where_a_body_is_folded);
  tcase_add_loop_test(tests, energy_force_and_stiffness_are_a_taylor_series, 0, 2);
  tcase_add_loop_test(tests, every_pair_balances, 0, LAWS);
  tcase_add_loop_test(tests, flat_surfaces_press_with_the_law_s_pressure, 0, LAWS);
  tcase_add_test(tests, the_unit_of_length_is_of_no_account);
  return suite_run("law", tests, 60);
}
