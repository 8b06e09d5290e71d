// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/sweep.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "fem/gradient/path/dominance.h"
#include "fem/sparse/vector.h"

// Of a step's right side, the share that may be left; of that, what GMRES' own estimate may be. What is left
// beyond it is solved for again. Where mass dominates a hundredth takes two or three products more, which are
// cheap.
static const double RESIDUAL = 1e-12, AIM = 0.5, LIGHT_AIM = 0.01;
// A factor of a later step serves on until GMRES takes more directions: a new one costs more than as many.
enum { MOST_DIRECTIONS = 8, MAX_ROUNDS = 3 };

size_t fem_sweep_value_count(const FemSweep *sweep) {
  return 3 * (size_t)sweep->replay.system.model->vertex_count;
}

bool fem_sweep_has_friction(const FemSweep *sweep) {
  return sweep->replay.stick != NULL;
}

static bool is_damped(const FemSweep *sweep) {
  return sweep->damping.effect != NULL;
}

static void destroy_goal(FemSweepGoal *goal) {
  memory_free(goal->beta);
  memory_free(goal->alpha);
  memory_free(goal->places);
  memory_free(goal->histories);
  memory_free(goal->moves);
  fem_friction_destroy(&goal->friction);
  fem_damping_destroy(&goal->damping);
  fem_yielding_destroy(&goal->yielding);
  fem_answers_destroy(&goal->answers);
}

void fem_sweep_destroy(FemSweep *sweep) {
  for (int g = 0; sweep->goals && g < sweep->def->goal_count; g++) destroy_goal(&sweep->goals[g]);
  fem_friction_destroy(&sweep->scratch);
  fem_damping_destroy(&sweep->damping);
  fem_krylov_destroy(&sweep->krylov);
  fem_change_destroy(&sweep->change);
  fem_tangent_destroy(&sweep->tangent);
  fem_varied_destroy(&sweep->varied);
  fem_replay_destroy(&sweep->replay);
  void *arrays[] = {sweep->goals, sweep->lambda,     sweep->weight,  sweep->slope,
                    sweep->right, sweep->correction, sweep->factors, sweep->diagonal};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
}

static Status create_goal(const FemSweep *sweep, FemSweepGoal *goal) {
  size_t n = (size_t)sweep->replay.n;
  goal->beta = memory_zeroed(3 * n, sizeof(double));
  goal->alpha = memory_zeroed(3 * n, sizeof(double));
  if (!goal->beta || !goal->alpha) return status_no_memory("the adjoint of a run");
  TRY(fem_damping_create(&goal->damping, &sweep->replay.system));
  TRY(fem_yielding_create(&goal->yielding, &sweep->replay.system));
  if (!fem_sweep_has_friction(sweep)) return STATUS_OK;
  TRY(fem_friction_create(&goal->friction, &sweep->replay.system));
  goal->places = memory_zeroed(fem_sweep_value_count(sweep), sizeof(double));
  goal->moves = memory_zeroed((size_t)goal->friction.interface_count, sizeof *goal->moves);
  return goal->places && goal->moves ? STATUS_OK : status_no_memory("the adjoint of a run");
}

static Status multiply(void *self, const double *x, double *y);

static Status precondition(void *self, const double *x, double *y) {
  FemSweep *sweep = self;
  if (!sweep->is_light) return fem_equilibrium_solve(&sweep->replay.adjoint, x, y);
  for (int i = 0; i < sweep->replay.n; i++) y[i] = x[i] / sweep->diagonal[i];
  return STATUS_OK;
}

Status fem_sweep_create(FemSweep *sweep, const FemModel *model, const FemGradientDef *def,
                        const FemReplaySteps *steps) {
  size_t goals = (size_t)def->goal_count, terms = 0;
  *sweep = (FemSweep){.def = def};
  TRY(fem_replay_create(&sweep->replay, model, steps));
  TRY(fem_varied_create(&sweep->varied, model));
  TRY(fem_tangent_create(&sweep->tangent, &sweep->replay.system));
  TRY(fem_change_create(&sweep->change, &sweep->tangent));
  size_t n = (size_t)sweep->replay.n, values = fem_sweep_value_count(sweep);
  for (size_t g = 0; g < goals; g++) terms += (size_t)def->goals[g].term_count;
  sweep->goals = memory_zeroed(goals, sizeof *sweep->goals);
  sweep->lambda = memory_zeroed(values, sizeof(double));
  sweep->weight = memory_zeroed(values, sizeof(double));
  sweep->slope = memory_zeroed(goals * values, sizeof(double));
  sweep->right = memory_zeroed(n, sizeof(double));
  sweep->correction = memory_zeroed(n, sizeof(double));
  sweep->diagonal = memory_zeroed(n, sizeof(double));
  sweep->factors = memory_zeroed(terms, sizeof(double));
  if (!sweep->goals || !sweep->lambda || !sweep->weight || !sweep->slope || !sweep->right ||
      !sweep->correction || !sweep->diagonal || !sweep->factors)
    return status_no_memory("the adjoint of a run");
  for (size_t g = 0; g < goals; g++) TRY(create_goal(sweep, &sweep->goals[g]));
  TRY(fem_damping_create(&sweep->damping, &sweep->replay.system));
  if (fem_sweep_has_friction(sweep)) TRY(fem_friction_create(&sweep->scratch, &sweep->replay.system));
  sweep->krylov = (FemKrylov){.self = sweep, .multiply = multiply, .precondition = precondition};
  return fem_krylov_create(&sweep->krylov, (int)n);
}

// ---- The adjoint of a step.

// The numbers of a step, its places in a ring of three.
static double *of_step(const FemSweep *sweep, double *ring, int k) {
  return ring + (size_t)sweep->replay.n * (size_t)(k % 3);
}

double *fem_sweep_beta(const FemSweep *sweep, const FemSweepGoal *goal) {
  return of_step(sweep, goal->beta, sweep->step);
}

double fem_sweep_carried(const FemSweep *sweep, double *ring, int k, int i) {
  double near = fem_replay_formula(&sweep->replay, k + 1).near * of_step(sweep, ring, k + 1)[i];
  return near + fem_replay_formula(&sweep->replay, k + 2).far * of_step(sweep, ring, k + 2)[i];
}

void fem_sweep_spread(FemSweep *sweep, const double *x, double sign) {
  const FemNumbering *numbering = &sweep->replay.system.numbering;
  memset(sweep->lambda, 0, fem_sweep_value_count(sweep) * sizeof(double));
  for (int i = 0; i < numbering->count; i++) sweep->lambda[numbering->dof_of_unknown[i]] = sign * x[i];
}

// y = (−∂f/∂u − c ∂f/∂v + c² M)ᵀ x, exact.
static Status multiply(void *self, const double *x, double *y) {
  FemSweep *sweep = self;
  const FemNumbering *numbering = &sweep->replay.system.numbering;
  double c = fem_replay_formula(&sweep->replay, sweep->step).c;
  fem_sweep_spread(sweep, x, 1);
  TRY(fem_tangent_pull(&sweep->tangent, sweep->lambda, sweep->weight));
  if (fem_sweep_has_friction(sweep)) {
    TRY(fem_friction_begin(&sweep->scratch, &sweep->replay.state));
    TRY(fem_friction_pull(&sweep->scratch, CONTACT_ALL_INTERFACES, sweep->lambda, 1));
  }
  fem_damping_begin(&sweep->damping, &sweep->replay.state);
  TRY(fem_damping_pull(&sweep->damping, sweep->lambda, 1));
  for (int i = 0; i < numbering->count; i++) {
    int dof = numbering->dof_of_unknown[i];
    y[i] = sweep->weight[dof] + c * c * fem_replay_mass(&sweep->replay, i) * x[i];
    if (fem_sweep_has_friction(sweep)) y[i] -= sweep->scratch.now[dof];
    if (is_damped(sweep)) y[i] -= sweep->damping.now[dof] + c * sweep->damping.rate[dof];
  }
  return STATUS_OK;
}

void fem_sweep_begin_step(FemSweep *sweep) {
  const FemMatrix *stiffness = &sweep->tangent.stiffness;
  const int *dofs = sweep->replay.system.numbering.dof_of_unknown;
  double c = fem_replay_formula(&sweep->replay, sweep->step).c;
  sweep->is_light = c > 0 && c >= fem_dominance_least(&sweep->replay.system, stiffness, dofs, sweep->weight);
  for (int i = 0; i < sweep->replay.n; i++)
    sweep->diagonal[i] =
        stiffness->value[stiffness->col_begin[dofs[i]]] + c * c * fem_replay_mass(&sweep->replay, i);
}

static Status factorise(FemSweep *sweep) {
  sweep->factorised = sweep->step;
  sweep->is_spent = false;
  return fem_replay_factorise(&sweep->replay, sweep->step);
}

bool fem_sweep_is_last(const FemSweep *sweep) {
  return sweep->step == sweep->replay.steps->count - 1;
}

double fem_sweep_slope(const FemSweep *sweep, int g, size_t dof) {
  const FemSweepGoal *goal = &sweep->goals[g];
  double slope = sweep->slope[fem_sweep_value_count(sweep) * (size_t)g + dof];
  if (is_damped(sweep)) slope += goal->damping.now[dof];
  if (goal->yielding.effect) slope += goal->yielding.now[dof];
  return fem_sweep_has_friction(sweep) ? slope + goal->places[dof] + goal->friction.now[dof] : slope;
}

double fem_sweep_rate(const FemSweep *sweep, int g, size_t dof) {
  return is_damped(sweep) ? sweep->goals[g].damping.rate[dof] : 0;
}

// What friction, damping, plasticity and all the rest have by λ = −x, in addition.
static Status pull_step(FemSweep *sweep, int g, const double *x) {
  FemSweepGoal *goal = &sweep->goals[g];
  double *slope = sweep->slope + fem_sweep_value_count(sweep) * (size_t)g;
  fem_sweep_spread(sweep, x, -1);
  TRY(fem_damping_pull(&goal->damping, sweep->lambda, 1));
  fem_yielding_pull(&goal->yielding, sweep->lambda, 1);
  if (fem_sweep_has_friction(sweep))
    TRY(fem_friction_pull(&goal->friction, CONTACT_ALL_INTERFACES, sweep->lambda, 1));
  TRY(fem_tangent_pull(&sweep->tangent, sweep->lambda, sweep->weight));
  for (size_t i = 0; i < fem_sweep_value_count(sweep); i++) slope[i] -= sweep->weight[i];
  return STATUS_OK;
}

// What is left of the step's system with a β that has been pulled; returns its length.
static double find_left(FemSweep *sweep, int g, const double *beta) {
  const FemSweepGoal *goal = &sweep->goals[g];
  const int *dofs = sweep->replay.system.numbering.dof_of_unknown;
  double c = fem_replay_formula(&sweep->replay, sweep->step).c;
  const double *s = of_step(sweep, goal->alpha, sweep->step);
  for (int i = 0; i < sweep->replay.n; i++)
    sweep->right[i] = -c * (s[i] + fem_sweep_rate(sweep, g, (size_t)dofs[i]) +
                            c * fem_replay_mass(&sweep->replay, i) * beta[i]) -
                      fem_sweep_carried(sweep, goal->alpha, sweep->step, i) -
                      fem_sweep_slope(sweep, g, (size_t)dofs[i]);
  return sqrt(fem_vector_dot(sweep->replay.n, sweep->right, sweep->right));
}

// β and `left` by the factor that is there.
static Status correct(FemSweep *sweep, int g, double share, double *beta, double *left) {
  TRY(fem_krylov_solve(&sweep->krylov, sweep->right, share, sweep->correction, NULL));
  for (int i = 0; i < sweep->replay.n; i++) beta[i] += sweep->correction[i];
  TRY(pull_step(sweep, g, sweep->correction));
  *left = find_left(sweep, g, beta);
  return STATUS_OK;
}

// β, and what is left of the right side. With the factor of a later step, if it serves; else with this one's,
// which all goals share.
static Status solve(FemSweep *sweep, int g, double *beta, double *residual) {
  *residual = 0;
  memset(beta, 0, (size_t)sweep->replay.n * sizeof *beta);
  double whole = find_left(sweep, g, beta), left = whole;
  if (whole == 0) return STATUS_OK; // after all terms
  for (int round = 0; round < MAX_ROUNDS && !(left <= RESIDUAL * whole); round++) {
    bool is_due = sweep->factorised == 0 || (sweep->is_spent && sweep->factorised != sweep->step);
    if (is_due && !sweep->is_light) TRY(factorise(sweep));
    double aim = sweep->is_light ? LIGHT_AIM : AIM;
    Status status = correct(sweep, g, aim * RESIDUAL * whole / left, beta, &left);
    if (sweep->is_light) { // but for damping and friction, of which the bound knows nothing
      if (status && status != STATUS_SOLVER) return status;
      sweep->is_light = !status && sweep->krylov.directions < FEM_KRYLOV_MOST;
      continue;
    }
    sweep->is_spent = sweep->is_spent || status || sweep->krylov.directions > MOST_DIRECTIONS;
    if (status && (status != STATUS_SOLVER || sweep->factorised == sweep->step)) return status;
  }
  *residual = left / whole;
  return STATUS_OK;
}

Status fem_sweep_solve_step(FemSweep *sweep, int g, double *largest) {
  int k = sweep->step;
  double c = fem_replay_formula(&sweep->replay, k).c, residual;
  FemSweepGoal *goal = &sweep->goals[g];
  double *beta = fem_sweep_beta(sweep, goal), *alpha = of_step(sweep, goal->alpha, k);
  const int *dofs = sweep->replay.system.numbering.dof_of_unknown;
  for (int i = 0; i < sweep->replay.n; i++)
    alpha[i] = fem_replay_mass(&sweep->replay, i) * fem_sweep_carried(sweep, goal->beta, k, i);
  TRY(solve(sweep, g, beta, &residual));
  TRY(fem_gradient_judge(residual, sweep->replay.steps->times[k]));
  *largest = fmax(*largest, residual);
  for (int i = 0; i < sweep->replay.n; i++)
    alpha[i] += c * fem_replay_mass(&sweep->replay, i) * beta[i] + fem_sweep_rate(sweep, g, (size_t)dofs[i]);
  return STATUS_OK;
}
