// SPDX-License-Identifier: GPL-3.0-or-later
// The energy audit alone: what it counts as dissipated between accepted states of known powers.
#include <math.h>

#include "fem/model/limits.h"
#include "fem/time/audit.h"
#include "suite.h"

typedef double Power(double time, double rate);

// What the audit counts as dissipated of a power from 0 to `end`, in even steps.
static double counted(Power *power, double rate, double end, int steps) {
  FemAudit audit;
  FemEnergy energy = {.kinetic = 1, .dissipated_power = power(0, rate)};
  fem_audit_begin(&audit, 0, &energy, 0);
  for (int i = 1; i <= steps; i++) {
    double time = end * i / steps;
    energy.dissipated_power = power(time, rate);
    audit = fem_audit_next(&audit, time, &energy);
  }
  return audit.damped;
}

// Of a damper between what swings at the angular frequency `rate`.
static double swing(double time, double rate) {
  double speed = cos(rate * time);
  return speed * speed;
}

static double decay(double time, double rate) {
  return exp(-2 * rate * time);
}

// Over whole periods the trapezoidal rule is exact. What is lacking is of steps beside the power's zeros,
// where it falls by more than to a half: (ω h)³ of a swing, where the logarithmic mean of every fall would
// lack (ω h)²/6.
START_TEST(of_a_swing_next_to_nothing_is_lacking) {
  const double there = 4 * M_PI; // four periods
  ck_assert_near(counted(swing, 1, 8 * M_PI, 4 * 100), there, 2e-4 * there);
  ck_assert_near(counted(swing, 1, 8 * M_PI, 4 * 20), there, 2e-2 * there);
}
END_TEST

// A mode that is gone within a step had only so much to lose.
START_TEST(of_what_falls_within_a_step_no_more_is_counted_than_there_was) {
  for (double rate = 5; rate < 300; rate *= 2) {
    double there = 0.5 / rate; // ∫ exp(−2 rate t)
    ck_assert_near(counted(decay, rate, 4, 4), there, 1e-2 * there);
  }
}
END_TEST

// Between both: as good as either, and without a jump.
START_TEST(from_the_one_to_the_other_it_goes_without_a_jump) {
  double before = NAN;
  for (double fall = 1.5; fall < 20; fall *= 1.01) {
    double rate = 0.5 * log(fall), there = (1 - 1 / fall) / (2 * rate);
    double error = counted(decay, rate, 1, 1) / there - 1;
    ck_assert(error >= -1e-12 && error < 0.09);
    if (!isnan(before)) ck_assert_near(error, before, 4e-3);
    before = error;
  }
}
END_TEST

START_TEST(a_power_that_ends_at_nothing_counts_in_part) {
  FemAudit audit, next;
  FemEnergy energy = {.kinetic = 1, .dissipated_power = 2};
  fem_audit_begin(&audit, 0, &energy, 0);
  energy.dissipated_power = 0;
  next = fem_audit_next(&audit, 1, &energy);
  ck_assert(next.damped >= 0 && next.damped <= 1);
}
END_TEST

// What is lost is what the ends of a step tell that was dissipated, or what it was at least: A falls with the
// latter, and tells no gain.
START_TEST(where_only_a_bound_of_what_is_dissipated_is_certain_the_total_takes_it) {
  FemEnergy energy = {.kinetic = 1, .dissipated_power = 2};
  const FemAuditBounds bounds = fem_audit_bounds(true, 0);
  FemAudit audit;
  fem_audit_begin(&audit, 0, &energy, 0);
  energy.kinetic = 0.9;
  FemAudit ends = fem_audit_next(&audit, 0.1, &energy), within;
  ck_assert(fem_audit_is_doubtful(&bounds, &audit, &ends));
  ck_assert_near(ends.damped, 0.2, 1e-14);
  within = fem_audit_next_within(&audit, 0.1, &energy, 0.5);
  ck_assert(!fem_audit_is_doubtful(&bounds, &audit, &within));
  ck_assert_near(within.damped, 0.05, 1e-14);
  ck_assert_near(within.dissipated, 0.05, 1e-14);
  ck_assert_near(within.total, 0.95, 1e-14);
  ck_assert_near(within.uncertain, 0.15, 1e-14);
  ck_assert_double_eq(within.gain, 0);
  ck_assert_near(fem_audit_lost(&within), 0.05, 1e-14);
  within = fem_audit_next_within(&audit, 0.1, &energy, 5);
  ck_assert_double_eq(within.damped, ends.damped);
}
END_TEST

// A force that rises by way is known from its ends. Where it stops to rise within a step, as friction does
// that slips, half of the change of force times way is open, and no gain is told of it.
START_TEST(of_steps_of_load_that_are_open_no_gain_is_told) {
  static const double forces[] = {0, 1, 2, 3, 3.2, 3.2, 3.2};
  const FemAuditBounds bounds = fem_audit_bounds(true, 0);
  FemAudit audit;
  FemEnergy energy = {.elastic = 0};
  fem_audit_begin(&audit, 0, &energy, 1);
  for (int i = 1; i < 7; i++) {
    double mean = 0.5 * (forces[i - 1] + forces[i]);
    audit.driven_work += mean;
    // The spring holds F²/2 and slips at 3.2: what is dissipated is the work but for what the rule lacks.
    energy.elastic = 0.5 * forces[i] * forces[i];
    energy.friction_work = i < 4 ? 0 : 3.2 * (i - 3.2);
    fem_audit_load_step(&audit, 1, forces[i - 1], forces[i], 0);
    audit = fem_audit_next(&audit, i, &energy);
    ck_assert_double_le(fem_audit_rise(&bounds, &audit), 1e-3);
  }
  ck_assert_near(audit.open, 0.5 * 1 + 0.5 * 0.2, 1e-12); // its first step, and where it slips
  ck_assert_double_le(audit.gain, 1e-12);
  ck_assert_double_gt(audit.total - audit.first, 0.05);
}
END_TEST

// The audit after a step by which the total rises by that share of the scene's energy.
static FemAudit rises_by(const FemAudit *audit, double share) {
  const FemEnergy energy = {.elastic = audit->total + share};
  FemAudit next = fem_audit_next(audit, audit->time + 1, &energy);
  next.scale = 1;
  return next;
}

// At the edge of both bounds: a step that just stands, and one that just does not.
START_TEST(a_step_is_refused_where_it_and_the_run_gain_more_than_their_bounds) {
  static const double LESS = 1 - 1e-6, MORE = 1 + 1e-6;
  const FemAuditBounds bounds = fem_audit_bounds(true, 0), free = fem_audit_bounds(false, 0);
  const FemEnergy none = {.elastic = 1};
  FemAudit start, run, next;
  fem_audit_begin(&start, 0, &none, 0);
  // The run has gained just less, or just more, than 0.8 of its bound; the step just less, or more, than
  // rounding.
  for (int is_more = 0; is_more < 2; is_more++) {
    run = rises_by(&start, (is_more ? MORE : LESS) * 8e-4 - (is_more ? 0 : MORE * 1e-6));
    next = rises_by(&run, MORE * 1e-6);
    ck_assert_int_eq(fem_audit_is_refused(&bounds, &run, &next), is_more);
    ck_assert(!fem_audit_is_refused(&free, &run, &next)); // without contact none is taken back
    next = rises_by(&run, LESS * 1e-6);
    ck_assert(!fem_audit_is_refused(&bounds, &run, &next));
  }
  next = rises_by(&start, NAN);
  ck_assert(fem_audit_is_refused(&bounds, &start, &next));
}
END_TEST

START_TEST(a_gain_is_doubtful_beyond_what_a_step_may_always_gain) {
  const FemAuditBounds bounds = fem_audit_bounds(true, 0);
  const FemEnergy none = {.elastic = 1};
  FemAudit start;
  fem_audit_begin(&start, 0, &none, 0);
  FemAudit less = rises_by(&start, 0.999 * FEM_ENERGY_STEP), more = rises_by(&start, 1.001 * FEM_ENERGY_STEP);
  ck_assert(!fem_audit_is_doubtful(&bounds, &start, &less));
  ck_assert(fem_audit_is_doubtful(&bounds, &start, &more));
}
END_TEST

// A step of `length` that gains with `power`, from where the audit stands.
static FemAudit gaining(const FemAudit *audit, double length, double power) {
  FemAudit next = *audit;
  next.time += length;
  next.total += length * power;
  return next;
}

// Steps that gain with a power which does not fall with their length are not refused, once that is known.
START_TEST(what_forces_give_by_themselves_is_not_cut_down) {
  const FemAuditBounds bounds = fem_audit_bounds(true, 0);
  const double shorter = FEM_CUT * FEM_CUT, power = 1e-2;
  FemAudit run = {.scale = 1, .total = FEM_ENERGY, .lowest = 0};
  FemAudit long_one = gaining(&run, 1, power);
  ck_assert(fem_audit_is_refused(&bounds, &run, &long_one));
  // Only the longest counts; one cut tells nothing; nor does what falls with the step.
  struct Case {
    double length, power;
    bool is_own;
  } cases[] = {{FEM_CUT, power, false},          {1.01 * shorter, power, false},
               {shorter, 0.49 * power, false},   {shorter, 0.51 * power, true},
               {FEM_CUT * shorter, power, true}, {shorter, 1.99 * power, true},
               {shorter, 2.01 * power, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    FemAudit audit = run, middle = gaining(&run, FEM_CUT, power);
    fem_audit_refuse(&audit, &long_one);
    fem_audit_refuse(&audit, &middle);
    FemAudit next = gaining(&audit, cases[i].length, cases[i].power);
    fem_audit_accept(&audit, &next);
    ck_assert_double_eq(audit.total, next.total);
    ck_assert_double_eq(audit.refused_step, 0);
    ck_assert_near(audit.own_power, cases[i].is_own ? cases[i].power : 0, 1e-12);
  }
  // Twice as much stands, more does not; after a step that gains nothing neither does.
  run.own_power = power;
  FemAudit less = gaining(&run, 1, 1.99 * power), more = gaining(&run, 1, 2.01 * power);
  ck_assert(!fem_audit_is_refused(&bounds, &run, &less));
  ck_assert(fem_audit_is_refused(&bounds, &run, &more));
  FemAudit held = run, still = gaining(&run, 1, 0);
  fem_audit_accept(&held, &less);
  ck_assert_double_eq(held.own_power, power);
  FemAudit little = gaining(&held, 1, 0.25 * power);
  fem_audit_accept(&held, &little);
  ck_assert_near(held.own_power, 0.5 * power, 1e-9 * power);
  fem_audit_accept(&run, &still);
  ck_assert_double_eq(run.own_power, 0);
  ck_assert(fem_audit_is_refused(&bounds, &run, &less));
}
END_TEST

// What steps may use up lies within what the run promises; without contact the promise is twenty times as
// wide.
START_TEST(bounds_of_steps_keep_the_promises_of_runs) {
  ck_assert_double_eq(fem_audit_bounds(true, 0).run, 1e-3);
  ck_assert_double_eq(fem_audit_bounds(false, 0).run, 2e-2);
  ck_assert_double_le(FEM_ENERGY_NEAR + FEM_ENERGY_REVERSED, FEM_ENERGY * (1 + 1e-12));
  ck_assert_double_lt(FEM_ENERGY_NEAR, FEM_ENERGY);
  ck_assert_double_lt(FEM_MOMENTUM_NEAR, FEM_MOMENTUM_FAR);
  ck_assert_double_lt(FEM_MOMENTUM_FAR + FEM_MOMENTUM_STEP, FEM_MOMENTUM);
  ck_assert_double_lt(FEM_MOMENTUM_STRICT, FEM_MOMENTUM_NEAR);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("audit");
  tcase_add_test(cases, a_step_is_refused_where_it_and_the_run_gain_more_than_their_bounds);
  tcase_add_test(cases, what_forces_give_by_themselves_is_not_cut_down);
  tcase_add_test(cases, a_gain_is_doubtful_beyond_what_a_step_may_always_gain);
  tcase_add_test(cases, bounds_of_steps_keep_the_promises_of_runs);
  tcase_add_test(cases, of_a_swing_next_to_nothing_is_lacking);
  tcase_add_test(cases, of_what_falls_within_a_step_no_more_is_counted_than_there_was);
  tcase_add_test(cases, from_the_one_to_the_other_it_goes_without_a_jump);
  tcase_add_test(cases, a_power_that_ends_at_nothing_counts_in_part);
  tcase_add_test(cases, where_only_a_bound_of_what_is_dissipated_is_certain_the_total_takes_it);
  tcase_add_test(cases, of_steps_of_load_that_are_open_no_gain_is_told);
  return suite_run("audit", cases, 20);
}
