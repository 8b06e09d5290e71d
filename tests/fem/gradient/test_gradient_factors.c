// SPDX-License-Identifier: GPL-3.0-or-later
// A factor serves many steps of a path, and what its gradient says of itself stays true.
#include <math.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "replays.h"

enum { MOST_STEPS = 1000 };

// What the functions that are replaced saw, and whether the first solution by an earlier factor fails.
static int factorised[MOST_STEPS], step_factorised, step_here, couplings, factors_ahead;
static double largest_left;
static bool is_failing, has_failed;
// Whether steps in which mass dominates do without a factor.
static bool may_be_light;
// Whether a factor, but within GMRES, gets on badly with small forces, and the largest that it met.
static bool is_poor, is_within_gmres;
static double largest_force;
static const FemReplay *running;

Status __real_fem_system_couple(FemSystem *system, const FemState *state);
Status __wrap_fem_system_couple(FemSystem *system, const FemState *state);
Status __real_fem_replay_return(FemReplay *replay, int k);
Status __wrap_fem_replay_return(FemReplay *replay, int k);
Status __real_fem_replay_factorise(FemReplay *replay, int k);
Status __wrap_fem_replay_factorise(FemReplay *replay, int k);
Status __real_fem_inverse_make(FemInverse *inverse, double time, const double *u, const double *v, double c);
Status __wrap_fem_inverse_make(FemInverse *inverse, double time, const double *u, const double *v, double c);
double __real_fem_dominance_least(const FemSystem *system, const FemMatrix *stiffness, const int *places,
                                  double *rows);
double __wrap_fem_dominance_least(const FemSystem *system, const FemMatrix *stiffness, const int *places,
                                  double *rows);
Status __real_fem_equilibrium_solve(FemEquilibrium *equilibrium, const double *b, double *x);
Status __wrap_fem_equilibrium_solve(FemEquilibrium *equilibrium, const double *b, double *x);
Status __real_fem_krylov_solve(FemKrylov *krylov, const double *b, double tolerance, double *x,
                               double *residual);
Status __wrap_fem_krylov_solve(FemKrylov *krylov, const double *b, double tolerance, double *x,
                               double *residual);

Status __wrap_fem_replay_return(FemReplay *replay, int k) {
  running = replay;
  step_here = k;
  return __real_fem_replay_return(replay, k);
}

Status __wrap_fem_system_couple(FemSystem *system, const FemState *state) {
  couplings += running != NULL; // on the way back
  return __real_fem_system_couple(system, state);
}

Status __wrap_fem_replay_factorise(FemReplay *replay, int k) {
  ck_assert_int_lt(k, MOST_STEPS);
  factorised[k]++;
  step_factorised = k;
  return __real_fem_replay_factorise(replay, k);
}

Status __wrap_fem_inverse_make(FemInverse *inverse, double time, const double *u, const double *v, double c) {
  Status status = __real_fem_inverse_make(inverse, time, u, v, c);
  factors_ahead += running == NULL && !inverse->is_light;
  return status;
}

double __wrap_fem_dominance_least(const FemSystem *system, const FemMatrix *stiffness, const int *places,
                                  double *rows) {
  return may_be_light ? __real_fem_dominance_least(system, stiffness, places, rows) : INFINITY;
}

Status __wrap_fem_equilibrium_solve(FemEquilibrium *equilibrium, const double *b, double *x) {
  static const double SMALL = 5e-10, SHARE = 0.3;
  int count = equilibrium->system->numbering.count;
  double largest = fem_equilibrium_largest(b, count);
  largest_force = fmax(largest_force, largest);
  Status status = __real_fem_equilibrium_solve(equilibrium, b, x);
  for (int i = 0; i < count && is_poor && !is_within_gmres && largest < SMALL * largest_force; i++)
    x[i] *= SHARE;
  return status;
}

static double left_of(FemKrylov *krylov, const double *b, const double *x) {
  double *product = memory_zeroed((size_t)krylov->count, sizeof *product), left = 0, whole = 0;
  ck_assert_ok(krylov->multiply(krylov->self, x, product));
  for (int i = 0; i < krylov->count; i++) {
    left += (b[i] - product[i]) * (b[i] - product[i]);
    whole += b[i] * b[i];
  }
  memory_free(product);
  return sqrt(left / whole);
}

Status __wrap_fem_krylov_solve(FemKrylov *krylov, const double *b, double tolerance, double *x,
                               double *residual) {
  if (running && is_failing && !has_failed && step_factorised != step_here) {
    has_failed = true;
    return status_fail(STATUS_SOLVER, "an earlier factor");
  }
  is_within_gmres = true;
  Status status = __real_fem_krylov_solve(krylov, b, tolerance, x, residual);
  is_within_gmres = false;
  if (running && !status) largest_left = fmax(largest_left, left_of(krylov, b, x));
  return status;
}

static void differentiate(const Asked *asked, bool fails, FemReplaySteps *steps, Answer *answer) {
  memset(factorised, 0, sizeof factorised);
  largest_left = 0, step_factorised = 0, couplings = 0, factors_ahead = 0, running = NULL, has_failed = false;
  is_failing = fails;
  replay(asked, steps, NULL, true, answer);
}

enum { MOTION, SLIDE, DAMPED, RUB, SCENE_COUNT };

static const char *const scenes[SCENE_COUNT] = {"gradient_motion", "gradient_slide", "gradient_damped",
                                                "gradient_rub"};

static Asked asked_of(int scene) {
  return (Asked){.scene = scenes[scene],
                 .setting = scene == RUB ? "time.end=1" : "time.end=0.02",
                 .least_steps = 7,
                 .of = {"displacement:upper:z", "position:upper:3:x", "energy", "displacement:lower:x"},
                 .by = {"bodies.lower.material.young", "contact.stiffness"}};
}

// The steps that a factor was made at; at none was a second one.
static int count_factors(const FemReplaySteps *steps) {
  int count = 0;
  for (int k = 0; k < steps->count; k++) {
    ck_assert_msg(factorised[k] <= 1, "step %d was factorised %d times", k, factorised[k]);
    count += factorised[k];
  }
  return count;
}

// In a static scene a step goes far, so that a factor serves one or two.
START_TEST(goals_share_a_factor_which_serves_many_steps) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer answer;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &answer);
  int count = count_factors(&steps);
  ck_assert_int_gt(count, 0);
  if (_i != RUB) ck_assert_int_lt(2 * count, steps.count);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// The run's steps grow and shrink, and a factor of another length serves: but for those with which the replay
// begins anew there are few.
START_TEST(the_replay_keeps_a_factor_over_steps_of_other_lengths) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer answer;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &answer);
  double shortest = INFINITY, longest = 0;
  for (int k = 1; k < steps.count; k++) {
    shortest = fmin(shortest, steps.times[k] - steps.times[k - 1]);
    longest = fmax(longest, steps.times[k] - steps.times[k - 1]);
  }
  ck_assert_double_gt(longest, 4 * shortest);
  ck_assert_int_ge(factors_ahead, 1);
  ck_assert_int_lt(10 * factors_ahead, steps.count);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// Vertices come a little way in a step of a motion.
START_TEST(what_may_meet_is_looked_for_where_bodies_have_moved) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer answer;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &answer);
  int looked = couplings - count_factors(&steps); // each factor looks, too
  ck_assert_int_gt(looked, 0);
  ck_assert_int_lt(2 * looked, steps.count);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

static double reach_with(const char *margin, const char *self) {
  SceneRun scene;
  FemSystem system;
  scene_open(&scene, "gradient_motion", (const char *const[]){margin, self, NULL});
  ck_assert_ok(fem_system_create(&system, &scene.model));
  double reach = fem_effect_contact_reach(fem_system_effect(&system, &fem_effect_contact));
  fem_system_destroy(&system);
  scene_close(&scene);
  return reach;
}

// Half of the margin may be used up when candidates are asked for, and self-contact has half the margin.
START_TEST(nothing_is_laid_out_ahead_beyond_what_was_searched) {
  double usual = reach_with("contact.margin=1", NULL);
  ck_assert_double_gt(usual, 4e-3);
  ck_assert_double_lt(usual, 0.1);
  ck_assert_double_eq(reach_with("contact.margin=4e-3", NULL), 2e-3);
  ck_assert_double_eq(reach_with("contact.margin=4e-3", "bodies.lower.self_contact=true"), 1e-3);
}
END_TEST

START_TEST(the_residual_that_is_told_is_that_of_the_worst_system) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer answer;
  double told = 0;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &answer);
  for (int g = 0; g < answer.goal_count; g++) told = fmax(told, answer.gradient.residuals[g]);
  ck_assert_near(told, largest_left,
                 1e-2 * largest_left); // each is a difference of numbers 1e12 times as large
  ck_assert_double_gt(told, 0);
  ck_assert_double_le(told, 1e-12);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// Of each step 1e-12 is left; two integrations over some hundred steps may make 1e-8 of it.
static void check_same(const Answer *plain, const Answer *other) {
  for (int i = 0; i < plain->goal_count * plain->parameter_count; i++) {
    double share =
        plain->gradient.values[i / plain->parameter_count] / plain->values[i % plain->parameter_count];
    ck_assert_near(other->gradient.derivatives[i], plain->gradient.derivatives[i],
                   1e-8 * fmax(fabs(share), fabs(plain->gradient.derivatives[i])));
  }
}

START_TEST(an_earlier_factor_that_does_not_serve_is_made_anew) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer plain, other;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &plain);
  int count = count_factors(&steps);
  differentiate(&asked, true, &steps, &other);
  ck_assert(has_failed);
  ck_assert_int_ge(count_factors(&steps), count);
  check_same(&plain, &other);
  destroy(&plain);
  destroy(&other);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// Those in which mass dominates; the derivatives are the same as by factors.
START_TEST(short_steps_take_fewer_factors) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer plain, other;
  find_steps(&asked, &steps);
  differentiate(&asked, false, &steps, &plain);
  int ahead = factors_ahead, back = count_factors(&steps);
  may_be_light = true;
  differentiate(&asked, false, &steps, &other);
  may_be_light = false;
  ck_assert_int_lt(factors_ahead, ahead);
  ck_assert_int_lt(count_factors(&steps), back);
  check_same(&plain, &other);
  for (int g = 0; g < other.goal_count; g++) ck_assert_double_le(other.gradient.residuals[g], 1e-12);
  destroy(&plain);
  destroy(&other);
  fem_replay_steps_destroy(&steps);
}
END_TEST

START_TEST(a_step_that_the_diagonal_does_not_serve_takes_a_factor) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer plain, other;
  find_steps(&asked, &steps);
  may_be_light = true;
  differentiate(&asked, false, &steps, &plain);
  int count = count_factors(&steps);
  differentiate(&asked, true, &steps, &other);
  may_be_light = false;
  ck_assert(has_failed);
  ck_assert_int_ge(count_factors(&steps), count);
  check_same(&plain, &other);
  destroy(&plain);
  destroy(&other);
  fem_replay_steps_destroy(&steps);
}
END_TEST

// Steps by a matrix that lacks something stagnate before they are balanced: GMRES goes on.
START_TEST(a_step_is_balanced_also_with_a_poor_matrix) {
  const Asked asked = asked_of(_i);
  FemReplaySteps steps;
  Answer answer;
  find_steps(&asked, &steps);
  largest_force = 0, is_poor = true;
  differentiate(&asked, false, &steps, &answer);
  is_poor = false;
  ck_assert_double_le(answer.gradient.unbalanced, 1e-11);
  destroy(&answer);
  fem_replay_steps_destroy(&steps);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_factors");
  tcase_add_loop_test(test_case, goals_share_a_factor_which_serves_many_steps, 0, SCENE_COUNT);
  tcase_add_loop_test(test_case, the_replay_keeps_a_factor_over_steps_of_other_lengths, 0, RUB);
  tcase_add_loop_test(test_case, what_may_meet_is_looked_for_where_bodies_have_moved, 0, RUB);
  tcase_add_test(test_case, nothing_is_laid_out_ahead_beyond_what_was_searched);
  tcase_add_loop_test(test_case, the_residual_that_is_told_is_that_of_the_worst_system, 0, SCENE_COUNT);
  tcase_add_loop_test(test_case, an_earlier_factor_that_does_not_serve_is_made_anew, 0, SCENE_COUNT);
  tcase_add_loop_test(test_case, short_steps_take_fewer_factors, 0, RUB);
  tcase_add_loop_test(test_case, a_step_that_the_diagonal_does_not_serve_takes_a_factor, 0, RUB);
  tcase_add_loop_test(test_case, a_step_is_balanced_also_with_a_poor_matrix, SLIDE, DAMPED + 1);
  return suite_run("gradient_factors", test_case, 120);
}
