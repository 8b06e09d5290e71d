// SPDX-License-Identifier: GPL-3.0-or-later
// base/expression: values and derivatives of formulas, and the refusal of everything else.
#include "suite.h"

#include <string.h>

#include "base/expression.h"
#include "base/random.h"

static ExpressionValue at(const char *text, double t) {
  Expression expression;
  ck_assert_ok(expression_parse(&expression, "t", text));
  return expression_eval(&expression, t);
}

START_TEST(precedence_is_that_of_mathematics) {
  ck_assert_double_eq(at("1 + 2*3", 0).value, 7);
  ck_assert_double_eq(at("(1 + 2)*3", 0).value, 9);
  ck_assert_double_eq(at("2^3^2", 0).value, 512);
  ck_assert_double_eq(at("-t^2", 3).value, -9);
  ck_assert_double_eq(at("2^-1", 0).value, 0.5);
  ck_assert_double_eq(at("8/2/2", 0).value, 2);
  ck_assert_double_eq(at("1 - 2 - 3", 0).value, -4);
  ck_assert_double_eq(at("- - 4", 0).value, 4);
  ck_assert_double_eq(at("1.5e-3*t", 2).value, 3e-3);
}
END_TEST

START_TEST(functions_have_their_values) {
  ck_assert_near(at("sin(pi/6)", 0).value, 0.5, 1e-15);
  ck_assert_double_eq(at("min(t, 2)", 3).value, 2);
  ck_assert_double_eq(at("max(t, 2)", 3).value, 3);
  ck_assert_double_eq(at("step(t - 1)", 0.5).value, 0);
  ck_assert_double_eq(at("step(t - 1)", 1).value, 1);
  ck_assert_double_eq(at("smooth(t/2)", 1).value, 0.5);
  ck_assert_double_eq(at("smooth(t)", 7).value, 1);
  ck_assert_double_eq(at("abs(-3) + floor(2.5) + sqrt(16) + log(exp(2))", 0).value, 11);
}
END_TEST

// Central differences: error h²/6 f''' ≈ 1e-9 of these functions, and rounding 1e-16/h = 1e-11.
START_TEST(rate_and_curve_are_the_derivatives) {
  static const char *const formulas[] = {
      "sin(3*t)*exp(-t)", "t^3/(1 + t^2)", "2^t",       "tan(t/2)",     "log(1 + t)", "sqrt(t + 2)*cos(t)",
      "smooth(t/3)",      "min(t, t^2)",   "max(1, t)", "abs(t - 5)*t", "t^t",        "-(t - 1)/(t + 1)",
      "cos(t^2)",         "(t^2)^sin(t)",  "1/sqrt(t)",
  };
  Random random = random_seeded(7, 1);
  for (size_t f = 0; f < sizeof formulas / sizeof *formulas; f++)
    for (int k = 0; k < 20; k++) {
      double t = 0.3 + 2 * random_uniform(&random), h = 1e-5;
      if (fabs(t - 1) < 1e-3) continue; // kinks of min and max
      double difference = (at(formulas[f], t + h).value - at(formulas[f], t - h).value) / (2 * h);
      ck_assert_near(at(formulas[f], t).rate, difference, 1e-7 * (1 + fabs(difference)));
      difference = (at(formulas[f], t + h).rate - at(formulas[f], t - h).rate) / (2 * h);
      ck_assert_near(at(formulas[f], t).curve, difference, 1e-7 * (1 + fabs(difference)));
    }
}
END_TEST

START_TEST(a_constant_power_is_differentiable_at_zero) {
  ck_assert_double_eq(at("t^2", 0).rate, 0);
  ck_assert_double_eq(at("t^1", 0).rate, 1);
  ck_assert_double_eq(at("(t - 1)^3", 0).rate, 3);
  ck_assert_double_eq(at("t^2", 0).curve, 2);
  ck_assert_double_eq(at("t^1", 0).curve, 0);
}
END_TEST

START_TEST(an_argument_may_have_another_name) {
  Expression expression;
  ck_assert_ok(expression_parse(&expression, "d", "2*d^3"));
  ExpressionValue value = expression_eval(&expression, 2);
  ck_assert_double_eq(value.value, 16);
  ck_assert_double_eq(value.rate, 24);
  ck_assert_double_eq(value.curve, 24);
  ck_assert_int_eq(expression_parse(&expression, "d", "2*t"), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "expected d, pi"));
}
END_TEST

static void refuse(const char *text, const char *expected) {
  Expression expression;
  ck_assert_int_eq(expression_parse(&expression, "t", text), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), expected), "%s: %s", text, status_message());
}

START_TEST(what_is_no_formula_is_refused_with_its_place) {
  refuse("", "at the end");
  refuse("1 +", "at the end");
  refuse("(1", "')'");
  refuse("1 2", "character 3");
  refuse("sin t", "'('");
  refuse("min(1)", "second value");
  refuse("sinus(t)", "did you mean sin");
  refuse("x", "expected t, pi");
  refuse("system(1)", "character 1");
  refuse("1..2", "a number");
  refuse("1e999", "a number");
  refuse("t;t", "operator");
}
END_TEST

START_TEST(length_and_nesting_are_bounded) {
  char deep[128] = "", longer[512] = "1", wide[160] = "1";
  for (int i = 0; i < 60; i++) strcat(deep, "(");
  refuse(deep, "nested too deeply");
  while (strlen(longer) < 300) strcat(longer, "+ 1");
  refuse(longer, "at most 199 characters");
  while (strlen(wide) < 150) strcat(wide, "+1");
  refuse(wide, "too long");
}
END_TEST

static double kink(const char *text, double t) {
  Expression expression;
  ck_assert_ok(expression_parse(&expression, "t", text));
  return expression_next_kink(&expression, t);
}

START_TEST(kinks_of_straight_arguments_are_foreseen) {
  ck_assert(isinf(kink("sin(t)+t^2", 0)));
  ck_assert_double_eq(kink("step(t-2)", 0), 2);
  ck_assert(isinf(kink("step(t-2)", 2)));
  ck_assert_double_eq(kink("3*abs(1-t/4)", 0), 4);
  ck_assert_double_eq(kink("floor(2*t)", 0.1), 0.5);
  ck_assert_double_eq(kink("floor(0-2*t)", 0), 0.5); // falls from 0 at once
  ck_assert_double_eq(kink("smooth((t-1)/2)", 0), 1);
  ck_assert_double_eq(kink("smooth((t-1)/2)", 1), 3);
  ck_assert(isinf(kink("smooth((t-1)/2)", 3)));
  ck_assert_double_eq(kink("smooth((1-t)/2)", -5), -1);
  ck_assert_double_eq(kink("min(t, 2-t)", 0), 1);
  ck_assert_double_eq(kink("max(t, 5)*sin(t)", 0), 5);
  ck_assert_double_eq(kink("abs(t-3)+step(t-2)", 0), 2);
  ck_assert_double_eq(kink("max(0, abs(t-3)-1)", 0), 2); // of what has a kink itself
  ck_assert_double_eq(kink("max(0, abs(t-3)-1)", 3), 4);
  ck_assert(isinf(kink("step(sin(t))", 0))); // not straight
  ck_assert(isinf(kink("step(t*t-2)", 0)));
  ck_assert_double_eq(kink("step(2^3*t-4)", 0), 0.5);
  ck_assert(isinf(kink("abs(pi)", 0)));
  // A period of a second.
  ck_assert_near(kink("smooth((t-floor(t)-0.25)/0.5)", 7.3), 7.75, 1e-14);
  ck_assert_near(kink("smooth((t-floor(t)-0.25)/0.5)", 7.8), 8, 1e-14);
}
END_TEST

START_TEST(what_cannot_be_computed_is_not_a_number) {
  ck_assert(!isfinite(at("1/t", 0).value));
  ck_assert(!isfinite(at("log(0 - t)", 1).value));
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("expression");
  tcase_add_test(test_case, precedence_is_that_of_mathematics);
  tcase_add_test(test_case, functions_have_their_values);
  tcase_add_test(test_case, rate_and_curve_are_the_derivatives);
  tcase_add_test(test_case, a_constant_power_is_differentiable_at_zero);
  tcase_add_test(test_case, an_argument_may_have_another_name);
  tcase_add_test(test_case, what_is_no_formula_is_refused_with_its_place);
  tcase_add_test(test_case, length_and_nesting_are_bounded);
  tcase_add_test(test_case, kinks_of_straight_arguments_are_foreseen);
  tcase_add_test(test_case, what_cannot_be_computed_is_not_a_number);
  return suite_run("expression", test_case, 30);
}
