// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/path.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "fem/gradient/path/start.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/laws.h"
#include "fem/sparse/vector.h"

// Of a system that GMRES solves, the share of the right side that may be left.
static const double RESIDUAL = 1e-14;
// The same, of one that is solved with the factor of a later step.
static const double KEPT = 1e-11;
// A factor of a later step serves on until GMRES takes more directions: a new one costs about as much.
enum { MOST_DIRECTIONS = 8 };

// What a goal has behind a step that was gone back over.
typedef struct Behind {
  double *beta, *alpha;   // of a step and the two behind it                   (3, n)
  double *places;         // by positions, through friction's last ones        (3 V)
  double (*histories)[3]; // by friction's history                             (history_count)
  double (*moves)[3];     // by what side 1 of each interface moves            (interface_count)
  size_t capacity;
  FemFriction friction; // of the step
  FemDamping damping;   // of the step
  FemAnswers answers;   // of the step
} Behind;

typedef struct Sweep {
  const FemGradientDef *def;
  FemReplay replay;
  FemTangent tangent;
  FemVaried varied;
  FemChange change;
  FemKrylov krylov;
  FemFriction scratch;
  FemDamping damping;              // scratch
  Behind *behind;                  // of each goal
  double *lambda, *weight, *slope; // scratch, and ∂g/∂x of each goal  (3 V), (3 V), (goal_count, 3 V)
  double *right;                   // scratch                          (n)
  double *factors;                 // of the terms of all goals
  int step, factorised;            // which, and of which step the factor is; 0: of none
  bool is_spent;                   // that factor
} Sweep;

static size_t values_of(const Sweep *sweep) {
  return 3 * (size_t)sweep->replay.system.model->vertex_count;
}

static bool has_friction(const Sweep *sweep) {
  return sweep->replay.stick != NULL;
}

static bool is_damped(const Sweep *sweep) {
  return sweep->damping.effect != NULL;
}

static void destroy_behind(Behind *behind) {
  memory_free(behind->beta);
  memory_free(behind->alpha);
  memory_free(behind->places);
  memory_free(behind->histories);
  memory_free(behind->moves);
  fem_friction_destroy(&behind->friction);
  fem_damping_destroy(&behind->damping);
  fem_answers_destroy(&behind->answers);
}

static void destroy(Sweep *sweep) {
  for (int g = 0; sweep->behind && g < sweep->def->goal_count; g++) destroy_behind(&sweep->behind[g]);
  fem_friction_destroy(&sweep->scratch);
  fem_damping_destroy(&sweep->damping);
  fem_krylov_destroy(&sweep->krylov);
  fem_change_destroy(&sweep->change);
  fem_tangent_destroy(&sweep->tangent);
  fem_varied_destroy(&sweep->varied);
  fem_replay_destroy(&sweep->replay);
  void *arrays[] = {sweep->behind, sweep->lambda, sweep->weight, sweep->slope, sweep->right, sweep->factors};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
}

static Status create_behind(const Sweep *sweep, Behind *behind) {
  size_t n = (size_t)sweep->replay.n;
  behind->beta = memory_zeroed(3 * n, sizeof(double));
  behind->alpha = memory_zeroed(3 * n, sizeof(double));
  if (!behind->beta || !behind->alpha) return status_no_memory("the adjoint of a run");
  TRY(fem_damping_create(&behind->damping, &sweep->replay.system));
  if (!has_friction(sweep)) return STATUS_OK;
  TRY(fem_friction_create(&behind->friction, &sweep->replay.system));
  behind->places = memory_zeroed(values_of(sweep), sizeof(double));
  behind->moves = memory_zeroed((size_t)behind->friction.interface_count, sizeof *behind->moves);
  return behind->places && behind->moves ? STATUS_OK : status_no_memory("the adjoint of a run");
}

static Status multiply(void *self, const double *x, double *y);

static Status precondition(void *self, const double *x, double *y) {
  return fem_equilibrium_solve(&((Sweep *)self)->replay.equilibrium, x, y);
}

static Status create(Sweep *sweep, const FemModel *model, const FemGradientDef *def,
                     const FemReplaySteps *steps) {
  size_t goals = (size_t)def->goal_count, terms = 0;
  *sweep = (Sweep){.def = def};
  TRY(fem_replay_create(&sweep->replay, model, steps));
  TRY(fem_varied_create(&sweep->varied, model));
  TRY(fem_tangent_create(&sweep->tangent, &sweep->replay.system));
  TRY(fem_change_create(&sweep->change, &sweep->tangent));
  size_t n = (size_t)sweep->replay.n, values = values_of(sweep);
  for (size_t g = 0; g < goals; g++) terms += (size_t)def->goals[g].term_count;
  sweep->behind = memory_zeroed(goals, sizeof *sweep->behind);
  sweep->lambda = memory_zeroed(values, sizeof(double));
  sweep->weight = memory_zeroed(values, sizeof(double));
  sweep->slope = memory_zeroed(goals * values, sizeof(double));
  sweep->right = memory_zeroed(n, sizeof(double));
  sweep->factors = memory_zeroed(terms, sizeof(double));
  if (!sweep->behind || !sweep->lambda || !sweep->weight || !sweep->slope || !sweep->right || !sweep->factors)
    return status_no_memory("the adjoint of a run");
  for (size_t g = 0; g < goals; g++) TRY(create_behind(sweep, &sweep->behind[g]));
  TRY(fem_damping_create(&sweep->damping, &sweep->replay.system));
  if (has_friction(sweep)) TRY(fem_friction_create(&sweep->scratch, &sweep->replay.system));
  sweep->krylov = (FemKrylov){.self = sweep, .multiply = multiply, .precondition = precondition};
  return fem_krylov_create(&sweep->krylov, (int)n);
}

// ---- The adjoint of a step.

// The numbers of a step, its places in a ring of three.
static double *of_step(const Sweep *sweep, double *ring, int k) {
  return ring + (size_t)sweep->replay.n * (size_t)(k % 3);
}

// s_k, at which two steps and their formulas meet.
static double carried(const Sweep *sweep, double *ring, int k, int i) {
  double near = fem_replay_formula(&sweep->replay, k + 1).near * of_step(sweep, ring, k + 1)[i];
  return near + fem_replay_formula(&sweep->replay, k + 2).far * of_step(sweep, ring, k + 2)[i];
}

static void spread(Sweep *sweep, const double *x, double sign) {
  const FemNumbering *numbering = &sweep->replay.system.numbering;
  memset(sweep->lambda, 0, values_of(sweep) * sizeof(double));
  for (int i = 0; i < numbering->count; i++) sweep->lambda[numbering->dof_of_unknown[i]] = sign * x[i];
}

// y = (−∂f/∂u − c ∂f/∂v + c² M)ᵀ x, exact.
static Status multiply(void *self, const double *x, double *y) {
  Sweep *sweep = self;
  const FemNumbering *numbering = &sweep->replay.system.numbering;
  double c = fem_replay_formula(&sweep->replay, sweep->step).c;
  spread(sweep, x, 1);
  TRY(fem_tangent_pull(&sweep->tangent, sweep->lambda, sweep->weight));
  if (has_friction(sweep)) {
    TRY(fem_friction_begin(&sweep->scratch, &sweep->replay.state));
    TRY(fem_friction_pull(&sweep->scratch, CONTACT_ALL_INTERFACES, sweep->lambda, 1));
  }
  fem_damping_begin(&sweep->damping, &sweep->replay.state);
  TRY(fem_damping_pull(&sweep->damping, sweep->lambda, 1));
  for (int i = 0; i < numbering->count; i++) {
    int dof = numbering->dof_of_unknown[i];
    y[i] = sweep->weight[dof] + c * c * fem_replay_mass(&sweep->replay, i) * x[i];
    if (has_friction(sweep)) y[i] -= sweep->scratch.now[dof];
    if (is_damped(sweep)) y[i] -= sweep->damping.now[dof] + c * sweep->damping.rate[dof];
  }
  return STATUS_OK;
}

static Status factorise(Sweep *sweep) {
  sweep->factorised = sweep->step;
  sweep->is_spent = false;
  return fem_replay_factorise(&sweep->replay, sweep->step);
}

static Status solve_with_factor(Sweep *sweep, double *beta, double *residual) {
  Status status = fem_krylov_solve(&sweep->krylov, sweep->right, RESIDUAL, beta, residual);
  sweep->is_spent = sweep->is_spent || status || sweep->krylov.directions > MOST_DIRECTIONS;
  return status;
}

// With the factor of a later step, if it serves; else with this one's, which all goals share.
static Status solve(Sweep *sweep, double *beta, double *residual) {
  *residual = 0;
  memset(beta, 0, (size_t)sweep->replay.n * sizeof *beta);
  if (fem_vector_dot(sweep->replay.n, sweep->right, sweep->right) == 0) return STATUS_OK; // behind all terms
  if (sweep->factorised > 0 && (!sweep->is_spent || sweep->factorised == sweep->step)) {
    Status status = solve_with_factor(sweep, beta, residual);
    bool is_fresh = sweep->factorised == sweep->step;
    if (is_fresh || (status && status != STATUS_SOLVER) || (!status && *residual <= KEPT)) return status;
  }
  TRY(factorise(sweep));
  return solve_with_factor(sweep, beta, residual);
}

static bool is_last(const Sweep *sweep) {
  return sweep->step == sweep->replay.steps->count - 1;
}

// ∂g/∂x of a goal at the step, at fixed velocities; its own only where it is taken.
static double slope_at(const Sweep *sweep, int g, size_t dof) {
  const Behind *behind = &sweep->behind[g];
  double slope = sweep->slope[values_of(sweep) * (size_t)g + dof];
  if (is_damped(sweep)) slope += behind->damping.now[dof];
  return has_friction(sweep) ? slope + behind->places[dof] + behind->friction.now[dof] : slope;
}

// The same by velocities.
static double rate_at(const Sweep *sweep, int g, size_t dof) {
  return is_damped(sweep) ? sweep->behind[g].damping.rate[dof] : 0;
}

// What friction and damping have by λ = −β.
static Status pull_step(Sweep *sweep, Behind *behind, const double *beta) {
  spread(sweep, beta, -1);
  TRY(fem_damping_pull(&behind->damping, sweep->lambda, 1));
  if (!has_friction(sweep)) return STATUS_OK;
  return fem_friction_pull(&behind->friction, CONTACT_ALL_INTERFACES, sweep->lambda, 1);
}

static Status solve_step(Sweep *sweep, int g, double *largest) {
  int k = sweep->step;
  double c = fem_replay_formula(&sweep->replay, k).c, residual;
  Behind *behind = &sweep->behind[g];
  double *beta = of_step(sweep, behind->beta, k), *alpha = of_step(sweep, behind->alpha, k);
  const int *dofs = sweep->replay.system.numbering.dof_of_unknown;
  for (int i = 0; i < sweep->replay.n; i++) {
    double s = fem_replay_mass(&sweep->replay, i) * carried(sweep, behind->beta, k, i);
    sweep->right[i] = -c * (s + rate_at(sweep, g, (size_t)dofs[i])) - carried(sweep, behind->alpha, k, i) -
                      slope_at(sweep, g, (size_t)dofs[i]);
    alpha[i] = s;
  }
  TRY(solve(sweep, beta, &residual));
  TRY(fem_gradient_judge(residual, sweep->replay.steps->times[k]));
  *largest = fmax(*largest, residual);
  TRY(pull_step(sweep, behind, beta));
  TRY(fem_tangent_pull(&sweep->tangent, sweep->lambda, sweep->weight));
  for (size_t i = 0; i < values_of(sweep); i++)
    sweep->slope[values_of(sweep) * (size_t)g + i] -= sweep->weight[i];
  for (int i = 0; i < sweep->replay.n; i++)
    alpha[i] += c * fem_replay_mass(&sweep->replay, i) * beta[i] + rate_at(sweep, g, (size_t)dofs[i]);
  return STATUS_OK;
}

// ---- What a step gives to the derivatives.

// −∂M/∂p v̇ of a density: what the vertices resist with.
static void resist(const Sweep *sweep, const FemParameter *parameter, FemChange *change) {
  const FemReplay *replay = &sweep->replay;
  const FemModel *model = replay->system.model;
  if (parameter->kind != FEM_PARAMETER_DENSITY || model->scene->is_static || sweep->step == 0) return;
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

// By constants of friction, and by the moves of what has no coordinates.
static double change_friction(const Sweep *sweep, const FemChange *change, const Behind *behind) {
  const FemFriction *friction = &behind->friction;
  double sum = 0;
  for (int i = 0; i < friction->interface_count && has_friction(sweep); i++) {
    sum += change->rates[i] * friction->stiffness[i] + change->slips[i] * friction->slip[i];
    if (!fem_change_moves(change, &sweep->tangent, i)) continue;
    for (int c = 0; c < 3; c++) sum -= change->shift[c] * (friction->moves[i][0][c] + behind->moves[i][c]);
  }
  return sum;
}

// Adds what the step gives by one parameter.
static Status add_step(Sweep *sweep, int p, FemGradient *gradient) {
  const FemGradientDef *def = sweep->def;
  FemChange *change = &sweep->change;
  const double *factors = sweep->factors;
  TRY(fem_change_find(change, &sweep->varied, &sweep->tangent, &def->parameters[p], def->follows_choice));
  resist(sweep, &def->parameters[p], change);
  for (int g = 0; g < def->goal_count; g++) {
    Behind *behind = &sweep->behind[g];
    double sum = 0;
    TRY(fem_goal_change(&def->goals[g], &sweep->tangent, factors, change, &sum));
    factors += def->goals[g].term_count;
    spread(sweep, of_step(sweep, behind->beta, sweep->step), sweep->step > 0 ? -1 : 0);
    for (size_t i = 0; i < values_of(sweep); i++)
      sum += sweep->lambda[i] * change->force[i] + slope_at(sweep, g, i) * change->motion[i] +
             rate_at(sweep, g, i) * change->speed[i];
    gradient->derivatives[g * def->parameter_count + p] += sum + change_friction(sweep, change, behind);
  }
  return STATUS_OK;
}

static Status add_parameters(Sweep *sweep, FemGradient *gradient) {
  const FemModel *model = sweep->replay.system.model;
  sweep->change.wants_elastic = false;
  for (int g = 0; g < sweep->def->goal_count; g++)
    if (fem_goal_is_due(&sweep->def->goals[g], model, sweep->replay.state.time))
      sweep->change.wants_elastic = true;
  for (int p = 0; p < sweep->def->parameter_count; p++) TRY(add_step(sweep, p, gradient));
  return STATUS_OK;
}

// What friction at this step hands to the step before.
static Status hand_back(Sweep *sweep, Behind *behind) {
  const FemFriction *friction = &behind->friction;
  int place = fem_effect_stick_place(sweep->replay.stick);
  size_t count = (size_t)fem_effect_stick_history(sweep->replay.stick, &sweep->replay.before.histories[place])
                     .entry_count;
  if (!memory_reserve((void **)&behind->histories, &behind->capacity, count + 1, sizeof *behind->histories))
    return status_no_memory("the adjoint of a run");
  memcpy(behind->histories, friction->before, count * sizeof *behind->histories);
  memcpy(behind->places, friction->then, values_of(sweep) * sizeof(double));
  for (int i = 0; i < friction->interface_count; i++)
    memcpy(behind->moves[i], friction->moves[i][1], sizeof behind->moves[i]);
  return STATUS_OK;
}

// ---- A step.

static Status evaluate_goals(Sweep *sweep, FemGradient *gradient) {
  double *factors = sweep->factors;
  memset(sweep->slope, 0, (size_t)sweep->def->goal_count * values_of(sweep) * sizeof(double));
  for (int g = 0; g < sweep->def->goal_count; g++) {
    sweep->tangent.friction = has_friction(sweep) ? &sweep->behind[g].friction : NULL;
    sweep->tangent.damping = &sweep->behind[g].damping;
    sweep->tangent.answers = gradient->weights ? &sweep->behind[g].answers : NULL;
    TRY(fem_goal_evaluate(&sweep->def->goals[g], &sweep->tangent, &gradient->values[g],
                          sweep->slope + values_of(sweep) * (size_t)g, factors));
    factors += sweep->def->goals[g].term_count;
  }
  sweep->tangent.friction = NULL;
  sweep->tangent.damping = NULL;
  sweep->tangent.answers = NULL;
  return STATUS_OK;
}

static Status begin_answers(Sweep *sweep, const FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count && gradient->weights; g++) {
    Behind *behind = &sweep->behind[g];
    TRY(fem_tangent_begin_answers(&sweep->tangent, &behind->answers));
    behind->friction.answers = behind->answers.by;
  }
  return STATUS_OK;
}

// What the step gives by weights, once friction and the goal have said their part.
static Status train(Sweep *sweep, FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count && gradient->weights; g++) {
    Behind *behind = &sweep->behind[g];
    sweep->tangent.answers = &behind->answers;
    spread(sweep, of_step(sweep, behind->beta, sweep->step), -1);
    TRY(fem_tangent_pull_contact(&sweep->tangent, CONTACT_ALL_INTERFACES, sweep->lambda, 1));
    TRY(fem_tangent_train(&sweep->tangent, gradient->weights + gradient->weight_count * (size_t)g));
  }
  sweep->tangent.answers = NULL;
  return STATUS_OK;
}

static Status begin_friction(Sweep *sweep) {
  const FemEffectHistory *next = fem_replay_histories(&sweep->replay, sweep->step);
  for (int g = 0; g < sweep->def->goal_count && has_friction(sweep); g++) {
    Behind *behind = &sweep->behind[g];
    TRY(fem_friction_begin(&behind->friction, &sweep->replay.state));
    if (is_last(sweep) || sweep->step == 0) continue;
    TRY(fem_friction_pull_history(&behind->friction, &next[fem_effect_stick_place(sweep->replay.stick)],
                                  (const double(*)[3])behind->histories));
  }
  return STATUS_OK;
}

static Status go_back_with(Sweep *sweep, FemGradient *gradient) {
  for (int g = 0; g < sweep->def->goal_count; g++)
    fem_damping_begin(&sweep->behind[g].damping, &sweep->replay.state);
  TRY(begin_answers(sweep, gradient));
  TRY(begin_friction(sweep));
  TRY(evaluate_goals(sweep, gradient));
  for (int g = 0; g < sweep->def->goal_count && sweep->step > 0; g++)
    TRY(solve_step(sweep, g, &gradient->residuals[g]));
  if (sweep->step > 0) TRY(train(sweep, gradient));
  TRY(add_parameters(sweep, gradient));
  for (int g = 0; g < sweep->def->goal_count && has_friction(sweep) && sweep->step > 0; g++)
    TRY(hand_back(sweep, &sweep->behind[g]));
  return STATUS_OK;
}

static Status go_back_to(Sweep *sweep, int k, FemGradient *gradient) {
  sweep->step = k;
  TRY(fem_replay_return(&sweep->replay, k));
  if (fem_replay_is_anew(&sweep->replay, k)) sweep->factorised = 0;
  TRY(fem_tangent_find(&sweep->tangent, &sweep->replay.state));
  return go_back_with(sweep, gradient);
}

// ---- Where the run begins.

// By a body's place: friction looks at where it was.
static void add_place(const Sweep *sweep, int p, FemGradient *gradient) {
  const FemGradientDef *def = sweep->def;
  const FemReplay *replay = &sweep->replay;
  const FemParameter *parameter = &def->parameters[p];
  if (parameter->kind != FEM_PARAMETER_PLACE || parameter->obstacle >= 0 || !has_friction(sweep)) return;
  const FemModelBody *body = &replay->system.model->bodies[parameter->body];
  for (int g = 0; g < def->goal_count; g++)
    for (int i = 0; i < replay->n; i++) {
      int dof = replay->system.numbering.dof_of_unknown[i];
      bool is_its = dof / 3 >= body->vertex_begin && dof / 3 < body->vertex_end;
      if (is_its && dof % 3 == parameter->component)
        gradient->derivatives[g * def->parameter_count + p] += sweep->behind[g].places[dof];
    }
}

// By the velocities that bodies start with: s_0.
static Status add_start(Sweep *sweep, int p, FemGradient *gradient) {
  const FemGradientDef *def = sweep->def;
  const FemReplay *replay = &sweep->replay;
  TRY(fem_start_find(replay->system.model, &def->parameters[p], sweep->weight));
  for (int g = 0; g < def->goal_count; g++)
    for (int i = 0; i < replay->n; i++)
      gradient->derivatives[g * def->parameter_count + p] +=
          sweep->weight[replay->system.numbering.dof_of_unknown[i]] * fem_replay_mass(replay, i) *
          carried(sweep, sweep->behind[g].beta, 0, i);
  return STATUS_OK;
}

static Status replay_and_return(Sweep *sweep, FemGradient *gradient) {
  FemReplay *replay = &sweep->replay;
  TRY(fem_replay_go(replay));
  gradient->unbalanced = replay->worst;
  gradient->switches = replay->switches;
  int first = has_friction(sweep) ? 0 : 1;
  for (int k = replay->steps->count - 1; k >= first; k--)
    TRY(fem_replay_end(replay, k, go_back_to(sweep, k, gradient)));
  gradient->replay_s = replay->spent_s;
  for (int p = 0; p < sweep->def->parameter_count; p++) {
    add_place(sweep, p, gradient);
    TRY(add_start(sweep, p, gradient));
  }
  return STATUS_OK;
}

// ---- What has a derivative.

static Status check_viscosity(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->contact.is_on && scene->contact.viscosity > 0)
    return status_fail(STATUS_INPUT, "contact.viscosity: its matrix is not exact by positions");
  if (scene->contact.is_on && scene->contact.rest_is_on)
    return status_fail(STATUS_INPUT, "contact.rest: bodies that fall asleep have no gradient");
  return STATUS_OK;
}

static Status check_released(const FemModel *model) {
  for (int d = 0; d < model->driver_count; d++)
    if (model->drivers[d].def->release > 0 || model->drivers[d].def->is_external)
      return status_fail(STATUS_INPUT, "what is released or moved from outside has no gradient in a motion");
  return STATUS_OK;
}

static Status check_motion(const FemModel *model, const FemGradientDef *def) {
  TRY(check_viscosity(model));
  TRY(check_released(model));
  for (int p = 0; p < def->parameter_count; p++) {
    const FemParameter *parameter = &def->parameters[p];
    if (parameter->kind == FEM_PARAMETER_PLACE && parameter->obstacle < 0)
      return status_fail(STATUS_INPUT, "the place of a body is a parameter of static scenes alone");
  }
  return STATUS_OK;
}

static bool rubs_on(const FemModel *model, int party) {
  for (int b = 0; b < model->body_count; b++)
    if (fem_compliance_friction(model, b, party).coefficient > 0) return true;
  return false;
}

static Status check_pairs(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (fem_laws_are_wanted(&scene->contact))
    return status_fail(STATUS_INPUT, "contact.law: with friction it has no gradient");
  for (int o = 0; o < scene->obstacle_count; o++)
    if (scene->obstacles[o].kind == FEM_OBSTACLE_BALL && rubs_on(model, fem_change_party(model, o)))
      return status_fail(STATUS_INPUT,
                         "obstacle '%s': friction on a sphere has no gradient; a body or a mesh obstacle has",
                         scene->obstacles[o].name);
  return STATUS_OK;
}

static Status check_friction(const FemModel *model, const FemGradientDef *def) {
  if (!fem_gradient_has_friction(model)) return STATUS_OK;
  if (fem_scene_has_breakaway(&model->scene->contact))
    return status_fail(STATUS_INPUT,
                       "contact.friction.static: friction that is larger at rest has no gradient: "
                       "a run may break away sooner or later");
  TRY(check_pairs(model));
  if (model->start)
    return status_fail(STATUS_INPUT, "start: with friction a run that goes on from another has no gradient");
  for (int p = 0; p < def->parameter_count; p++)
    if (def->parameters[p].kind == FEM_PARAMETER_SPIN && def->parameters[p].obstacle >= 0)
      return status_fail(STATUS_INPUT, "with friction there is no derivative by the spin of an obstacle");
  return STATUS_OK;
}

Status fem_path_check(const FemModel *model, const FemGradientDef *def) {
  if (!model->scene->is_static) TRY(check_motion(model, def));
  return check_friction(model, def);
}

static bool has_step(const FemReplaySteps *steps, const FemModel *model, const FemTerm *term) {
  for (int k = 1; k < steps->count; k++)
    if (fem_term_is_due(term, model, steps->times[k])) return true;
  return false;
}

static Status check_times(const FemModel *model, const FemGradientDef *def, const FemReplaySteps *steps) {
  for (int g = 0; g < def->goal_count; g++)
    for (int t = 0; t < def->goals[g].term_count; t++) {
      const FemTerm *term = &def->goals[g].terms[t];
      if (!has_step(steps, model, term))
        return status_fail(STATUS_INPUT, "no step of the run ends at t = %.9g s",
                           fmin(term->time, model->scene->end));
    }
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
  TRY(check_times(model, def, steps));
  Sweep sweep;
  Status status = create(&sweep, model, def, steps);
  sweep.replay.system.stop = stop;
  if (!status) status = replay_and_return(&sweep, gradient);
  destroy(&sweep);
  return status;
}
