// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/path.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/gradient/path/check.h"
#include "fem/gradient/path/start.h"
#include "fem/gradient/path/sweep.h"

// ---- What a step gives to the derivatives.

// −∂M/∂p v̇ of a density or a shape: what the vertices resist with.
static void resist(const FemSweep *sweep, FemChange *change) {
  const FemReplay *replay = &sweep->replay;
  const FemModel *model = replay->system.model;
  if (model->scene->is_static || sweep->step == 0) return;
  int k = sweep->step;
  FemReplayFormula formula = fem_replay_formula(replay, k);
  size_t n = (size_t)replay->n;
  const double *v = fem_replay_v(replay, k);
  for (size_t i = 0; i < n; i++) {
    int dof = replay->system.numbering.dof_of_unknown[i];
    double rate = formula.c * v[i] + formula.near * v[i - n] + (k > 1 ? formula.far * v[i - 2 * n] : 0);
    change->force[dof] -= change->masses[dof / 3] * rate;
  }
}

// By constants of friction, by shapes through what it remembers, and by the moves of what has no coordinates.
static double change_friction(const FemSweep *sweep, const FemChange *change, const FemSweepGoal *goal) {
  const FemFriction *friction = &goal->friction;
  bool is_looked_back_at = sweep->step > 0 && !fem_sweep_is_last(sweep);
  double sum = 0;
  for (int e = 0; e < change->shape.entry_count && is_looked_back_at; e++)
    sum += vec3_dot(vec3_at(goal->histories[e]), vec3_at(change->shape.stretches[e]));
  for (int i = 0; i < friction->interface_count && fem_sweep_has_friction(sweep); i++) {
    sum += change->rates[i] * friction->stiffness[i] + change->slips[i] * friction->slip[i];
    if (!fem_change_moves(change, &sweep->tangent, i)) continue;
    for (int c = 0; c < 3; c++) sum -= change->shift[c] * (friction->moves[i][0][c] + goal->moves[i][c]);
  }
  return sum;
}

// Adds what the step gives by one parameter.
static Status add_step(FemSweep *sweep, int p, FemGradient *gradient) {
  const FemGradientDef *def = sweep->def;
  FemChange *change = &sweep->change;
  const double *factors = sweep->factors;
  if (gradient->kinks[p]) return STATUS_OK;
  TRY(fem_gradient_pass(
      gradient, def, p,
      fem_change_find(change, &sweep->varied, &sweep->tangent, &def->parameters[p], def->follows_choice)));
  resist(sweep, change);
  for (int g = 0; g < def->goal_count; g++) {
    FemSweepGoal *goal = &sweep->goals[g];
    double sum = 0;
    TRY(fem_goal_change(&def->goals[g], &sweep->tangent, factors, change, &sum));
    factors += def->goals[g].term_count;
    fem_sweep_spread(sweep, fem_sweep_beta(sweep, goal), sweep->step > 0 ? -1 : 0);
    for (size_t i = 0; i < fem_sweep_value_count(sweep); i++)
      sum += sweep->lambda[i] * change->force[i] + fem_sweep_slope(sweep, g, i) * change->motion[i] +
             fem_sweep_rate(sweep, g, i) * change->speed[i];
    sum += change_friction(sweep, change, goal) + fem_yielding_change(&goal->yielding, &def->parameters[p]);
    gradient->derivatives[g * def->parameter_count + p] += sum;
  }
  return STATUS_OK;
}

static Status add_parameters(FemSweep *sweep, FemGradient *gradient) {
  const FemModel *model = sweep->replay.system.model;
  sweep->change.wants_elastic = false;
  for (int g = 0; g < sweep->def->goal_count; g++)
    if (fem_goal_is_due(&sweep->def->goals[g], model, sweep->replay.state.time))
      sweep->change.wants_elastic = true;
  for (int p = 0; p < sweep->def->parameter_count; p++) TRY(add_step(sweep, p, gradient));
  return STATUS_OK;
}

// What friction at this step hands to the step before.
static Status hand_back(FemSweep *sweep, FemSweepGoal *goal) {
  const FemFriction *friction = &goal->friction;
  int place = fem_effect_stick_place(sweep->replay.stick);
  size_t count = (size_t)fem_effect_stick_history(sweep->replay.stick, &sweep->replay.before.histories[place])
                     .entry_count;
  if (!memory_reserve((void **)&goal->histories, &goal->capacity, count + 1, sizeof *goal->histories))
    return status_no_memory("the adjoint of a run");
  memcpy(goal->histories, friction->before, count * sizeof *goal->histories);
  memcpy(goal->places, friction->then, fem_sweep_value_count(sweep) * sizeof(double));
  for (int i = 0; i < friction->interface_count; i++)
    memcpy(goal->moves[i], friction->moves[i][1], sizeof goal->moves[i]);
  return STATUS_OK;
}

// ---- A step.

static Status evaluate_goals(FemSweep *sweep, FemGradient *gradient) {
  double *factors = sweep->factors;
  memset(sweep->slope, 0, (size_t)sweep->def->goal_count * fem_sweep_value_count(sweep) * sizeof(double));
  for (int g = 0; g < sweep->def->goal_count; g++) {
    sweep->tangent.friction = fem_sweep_has_friction(sweep) ? &sweep->goals[g].friction : NULL;
    sweep->tangent.damping = &sweep->goals[g].damping;
    sweep->tangent.yielding = &sweep->goals[g].yielding;
    sweep->tangent.answers = gradient->weights ? &sweep->goals[g].answers : NULL;
    TRY(fem_goal_evaluate(&sweep->def->goals[g], &sweep->tangent, &gradient->values[g],
                          sweep->slope + fem_sweep_value_count(sweep) * (size_t)g, factors));
    factors += sweep->def->goals[g].term_count;
  }
  sweep->tangent.friction = NULL;
  sweep->tangent.damping = NULL;
  sweep->tangent.yielding = NULL;
  sweep->tangent.answers = NULL;
  return STATUS_OK;
}

static Status begin_answers(FemSweep *sweep, const FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count && gradient->weights; g++) {
    FemSweepGoal *goal = &sweep->goals[g];
    TRY(fem_tangent_begin_answers(&sweep->tangent, &goal->answers));
    goal->friction.answers = goal->answers.by;
  }
  return STATUS_OK;
}

// What the step gives by weights, once friction and the goal have said their part.
static Status train(FemSweep *sweep, FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count && gradient->weights; g++) {
    FemSweepGoal *goal = &sweep->goals[g];
    sweep->tangent.answers = &goal->answers;
    fem_sweep_spread(sweep, fem_sweep_beta(sweep, goal), -1);
    TRY(fem_tangent_pull_contact(&sweep->tangent, CONTACT_ALL_INTERFACES, sweep->lambda, 1));
    TRY(fem_tangent_train(&sweep->tangent, gradient->weights + gradient->weight_count * (size_t)g));
  }
  sweep->tangent.answers = NULL;
  return STATUS_OK;
}

static Status begin_friction(FemSweep *sweep) {
  const FemEffectHistory *next = fem_replay_histories(&sweep->replay, sweep->step);
  for (int g = 0; g < sweep->def->goal_count && fem_sweep_has_friction(sweep); g++) {
    FemSweepGoal *goal = &sweep->goals[g];
    TRY(fem_friction_begin(&goal->friction, &sweep->replay.state));
    if (fem_sweep_is_last(sweep) || sweep->step == 0) continue;
    TRY(fem_friction_pull_history(&goal->friction, &next[fem_effect_stick_place(sweep->replay.stick)],
                                  (const double(*)[3])goal->histories));
  }
  return STATUS_OK;
}

static Status go_back_with(FemSweep *sweep, FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count; g++) {
    fem_damping_begin(&sweep->goals[g].damping, &sweep->replay.state);
    fem_yielding_begin(&sweep->goals[g].yielding, &sweep->replay.state);
    if (sweep->step > 0) fem_yielding_pull_history(&sweep->goals[g].yielding);
  }
  TRY(begin_answers(sweep, gradient));
  TRY(begin_friction(sweep));
  TRY(evaluate_goals(sweep, gradient));
  for (int g = 0; g < sweep->def->goal_count && sweep->step > 0; g++)
    TRY(fem_sweep_solve_step(sweep, g, &gradient->residuals[g]));
  if (sweep->step > 0) TRY(train(sweep, gradient));
  TRY(add_parameters(sweep, gradient));
  for (int g = 0; g < sweep->def->goal_count && fem_sweep_has_friction(sweep) && sweep->step > 0; g++)
    TRY(hand_back(sweep, &sweep->goals[g]));
  return STATUS_OK;
}

static Status go_back_to(FemSweep *sweep, int k, FemGradient *gradient) {
  sweep->step = k;
  TRY(fem_replay_return(&sweep->replay, k));
  TRY(fem_tangent_find(&sweep->tangent, &sweep->replay.state));
  fem_sweep_begin_step(sweep);
  return go_back_with(sweep, gradient);
}

// ---- Where the run begins.

// By the positions and the velocities that bodies start with: α's sum and friction's look back, and s_0.
static Status add_start(FemSweep *sweep, int p, FemGradient *gradient) {
  const FemGradientDef *def = sweep->def;
  const FemReplay *replay = &sweep->replay;
  const FemModel *model = replay->system.model;
  double *places = sweep->lambda, *rates = sweep->weight;
  fem_shape_rest(model, &def->parameters[p], places);
  TRY(fem_start_find(model, &def->parameters[p], places, rates));
  for (int g = 0; g < def->goal_count; g++)
    for (int i = 0; i < replay->n; i++) {
      const FemSweepGoal *goal = &sweep->goals[g];
      int dof = replay->system.numbering.dof_of_unknown[i];
      double slope = fem_sweep_carried(sweep, goal->alpha, 0, i);
      if (fem_sweep_has_friction(sweep)) slope += goal->places[dof];
      gradient->derivatives[g * def->parameter_count + p] +=
          places[dof] * slope +
          rates[dof] * fem_replay_mass(replay, i) * fem_sweep_carried(sweep, goal->beta, 0, i);
    }
  return STATUS_OK;
}

static Status replay_and_return(FemSweep *sweep, FemGradient *gradient) {
  FemReplay *replay = &sweep->replay;
  TRY(fem_replay_go(replay));
  gradient->unbalanced = replay->worst;
  gradient->switches = replay->switches;
  gradient->yields = replay->yields;
  int first = fem_sweep_has_friction(sweep) ? 0 : 1;
  for (int k = replay->steps->count - 1; k >= first; k--)
    TRY(fem_replay_end(replay, k, go_back_to(sweep, k, gradient)));
  gradient->replay_s = replay->spent_s;
  for (int p = 0; p < sweep->def->parameter_count; p++) TRY(add_start(sweep, p, gradient));
  return STATUS_OK;
}

Status fem_path_differentiate(FemGradient *gradient, const FemModel *model, const FemGradientDef *def,
                              const FemReplaySteps *steps, const volatile sig_atomic_t *stop) {
  TRY(fem_gradient_create(gradient, def));
  TRY(fem_gradient_check(model, def));
  TRY(fem_path_check(model, def));
  TRY(fem_gradient_make_weights(gradient, model, def));
  for (int g = 0; g < def->goal_count; g++) gradient->mismatches[g] = NAN;
  if (steps->count < 2) return status_fail(STATUS_INPUT, "the run made no step");
  TRY(fem_path_check_times(model, def, steps));
  FemSweep sweep;
  Status status = fem_sweep_create(&sweep, model, def, steps);
  sweep.replay.system.stop = stop;
  if (!status) status = replay_and_return(&sweep, gradient);
  fem_sweep_destroy(&sweep);
  return status;
}
