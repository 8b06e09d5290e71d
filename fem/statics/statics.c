// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/statics/statics.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "fem/effect/gravity.h"
#include "fem/effect/loads.h"
#include "fem/statics/descent.h"
#include "fem/statics/kinsol.h"

// Equilibrium: this share of the largest force met, and of E · edge² at least.
static const double TOLERANCE = 1e-8, SMALLEST_SCALE = 1e-9;
// And not less than this many times the forces that rounding of a coordinate x causes, ε x · edge · E / (1 −
// 2ν): so a body without load is in equilibrium.
static const double FORCE_ROUNDING = 2;
// Relaxation hands over to Newton once the force has fallen to this share.
static const double HAND_OVER = 1e-3;
// The shift falls by this factor while the force stays the same: a shift that only follows the force would
// stay too large for elements that are heavy and soft.
static const double RELAXATION_FALL = 0.5;
// Where no equilibrium is found and an element has less than this of its volume, the law may be the reason.
static const double SQUEEZED = 0.3, SQUEEZED_STVK = 0.8;
enum { MAX_RELAXATIONS = 400, RELAXATION_REFUSALS = 40, WORST_COUNT = 3 };

static Status check_scene(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    for (int i = 0; i < body->fixed_count; i++)
      if (body->fixed[i].release > 0)
        return status_fail(STATUS_INPUT, "body '%s', fixed[%d]: a static scene cannot release vertices",
                           body->name, i);
    for (int i = 0; i < body->driven_count; i++)
      if (body->driven[i].release > 0)
        return status_fail(STATUS_INPUT, "body '%s', driven[%d]: a static scene cannot release vertices",
                           body->name, i);
    for (int c = 0; c < 3; c++)
      if (body->velocity[c] != 0 || body->spin[c] != 0)
        return status_fail(STATUS_INPUT, "body '%s' has a velocity; a static scene has none", body->name);
  }
  return STATUS_OK;
}

static double smallest_scale(const FemModel *model) {
  double softest = INFINITY, rounding = 0;
  for (int p = 0; p < model->part_count; p++) {
    const FemMaterial *material = &model->parts[p].material;
    const FemModelBody *body = &model->bodies[model->parts[p].body];
    double extent = fem_equilibrium_largest(model->rest + 3 * (size_t)body->vertex_begin,
                                            3 * (body->vertex_end - body->vertex_begin));
    double modulus = material->young / (1 - 2 * material->poisson);
    softest = fmin(softest, material->young);
    rounding = fmax(rounding, FORCE_ROUNDING * DBL_EPSILON * modulus * model->edge * extent);
  }
  return fmax(SMALLEST_SCALE * softest * model->edge * model->edge, rounding / TOLERANCE);
}

Status fem_statics_create(FemStatics *statics, FemSystem *system, FemState *state, const FemSolverOps *ops) {
  *statics = (FemStatics){.tolerance = TOLERANCE};
  const FemModel *model = system->model;
  TRY(check_scene(model->scene));
  size_t n = (size_t)system->numbering.count, values = 3 * (size_t)model->vertex_count;
  statics->force_scale = smallest_scale(model);
  statics->force = memory_zeroed(n, sizeof(double));
  statics->step = memory_zeroed(n, sizeof(double));
  statics->start = memory_zeroed(n, sizeof(double));
  statics->kept_force = memory_zeroed(values, sizeof(double));
  statics->kept_position = memory_copy(model->rest, values, sizeof(double));
  bool is_ok =
      statics->force && statics->step && statics->start && statics->kept_force && statics->kept_position;
  Status status =
      is_ok ? fem_equilibrium_create(&statics->equilibrium, system, state, ops) : status_no_memory("statics");
  if (status) fem_statics_destroy(statics);
  return status;
}

void fem_statics_destroy(FemStatics *statics) {
  fem_equilibrium_destroy(&statics->equilibrium);
  double *arrays[] = {statics->force, statics->step, statics->start, statics->kept_force,
                      statics->kept_position};
  for (int i = 0; i < 5; i++) memory_free(arrays[i]);
  *statics = (FemStatics){0};
}

// Forces at (time, u); the scale grows with the largest on any vertex, reactions included.
static Status evaluate(FemStatics *statics, double time, const double *u) {
  FemSystem *system = statics->equilibrium.system;
  TRY(fem_equilibrium_forces(&statics->equilibrium, time, u, statics->force));
  statics->force_scale =
      fmax(statics->force_scale, fem_equilibrium_largest(system->forces, 3 * system->model->vertex_count));
  return STATUS_OK;
}

// With contact by the work of the force; else KINSOL.
static Status newton(FemStatics *statics, double time, double *u) {
  const FemModel *model = statics->equilibrium.system->model;
  double tolerance = statics->tolerance * statics->force_scale;
  if (model->scene->contact.is_on)
    return fem_descent_solve(&statics->equilibrium, time, tolerance, u, &statics->newton_iterations);
  return fem_kinsol_solve(&statics->equilibrium, time, tolerance, model->length, u,
                          &statics->newton_iterations);
}

// One step of relaxation from u, whose forces are in `force`; RETRY: a larger shift is needed.
static Status relax_once(FemStatics *statics, double time, double shift, double *u) {
  FemEquilibrium *equilibrium = &statics->equilibrium;
  int n = equilibrium->system->numbering.count;
  double *step = statics->step;
  TRY(fem_equilibrium_factorise(equilibrium, time, u, shift));
  TRY(fem_equilibrium_solve(equilibrium, statics->force, step));
  double share = fem_equilibrium_longest_share(equilibrium, step);
  for (int i = 0; i < n; i++) u[i] += step[i] *= share;
  Status status = evaluate(statics, time, u);
  if (!status) status = fem_equilibrium_renew(equilibrium, time, u);
  if (status == STATUS_RETRY)
    for (int i = 0; i < n; i++) u[i] -= step[i];
  return status;
}

// Until the force has fallen far enough for Newton's method.
static Status relax(FemStatics *statics, double time, double *u) {
  int n = statics->equilibrium.system->numbering.count, refusals = 0;
  double shift = fem_equilibrium_first_shift(&statics->equilibrium);
  TRY(evaluate(statics, time, u));
  double first = fem_equilibrium_largest(statics->force, n), before = first;
  for (int k = 0; k < MAX_RELAXATIONS && before > HAND_OVER * first; k++) {
    Status status = relax_once(statics, time, shift, u);
    if (status < 0 || (status && ++refusals > RELAXATION_REFUSALS)) return status;
    if (status) {
      shift *= 10;
      TRY(evaluate(statics, time, u));
      continue;
    }
    statics->relaxation_steps++;
    double now = fem_equilibrium_largest(statics->force, n);
    shift *= RELAXATION_FALL * fmin(fmax(now / before, 0.4), 4);
    before = now;
  }
  return STATUS_OK;
}

// What is left at the state that Newton's method ended in: the element that is distorted most, with the law's
// limit where that may be the reason; then the vertices with the largest forces, since long messages are cut.
static Status say_why(FemStatics *statics, double time, const double *u) {
  FemSystem *system = statics->equilibrium.system;
  const FemModel *model = system->model;
  char cause[512], text[1024];
  size_t used = 0;
  const double *positions = statics->equilibrium.state->positions;
  snprintf(cause, sizeof cause, "%s", status_message());
  bool is_known = fem_equilibrium_forces(&statics->equilibrium, time, u, statics->force) == STATUS_OK;
  text_append(text, sizeof text, &used, "no equilibrium at t = %.9g: %s", time, cause);
  int flattest = 0;
  double smallest = INFINITY;
  for (int e = 0; e < model->tet_count; e++) {
    double J = fem_model_det(model, e, positions);
    if (J < smallest) smallest = J, flattest = e;
  }
  text_append(text, sizeof text, &used, "; element %d has the smallest det F, %.3g", flattest, smallest);
  FemMaterialLaw law = fem_model_law(model, flattest);
  if (smallest < (law == FEM_MATERIAL_STVK ? SQUEEZED_STVK : SQUEEZED))
    text_append(text, sizeof text, &used, ": %s", fem_material_limit(law));
  for (int k = 0; is_known && k < WORST_COUNT && k < system->numbering.count; k++) {
    int worst = 0;
    for (int i = 1; i < system->numbering.count; i++)
      if (fabs(statics->force[i]) > fabs(statics->force[worst])) worst = i;
    int dof = system->numbering.dof_of_unknown[worst], vertex = dof / 3;
    const double *x = positions + 3 * (size_t)vertex;
    text_append(text, sizeof text, &used,
                "%s %.3g N along %c on vertex %d of body '%s' at (%.4g, %.4g, %.4g)", k ? "," : ". Left are",
                statics->force[worst], "xyz"[dof % 3], vertex, fem_model_body_name(model, vertex), x[0], x[1],
                x[2]);
    statics->force[worst] = 0;
  }
  return status_fail(STATUS_RETRY, "%s", text);
}

// Work of driven vertices, mean force times way, and of turning gravity up; and of what holds the free ones
// where a run begins out of equilibrium: it lets go along the first step of load.
static void keep_work(FemStatics *statics, double time) {
  const FemSystem *system = statics->equilibrium.system;
  const FemModel *model = system->model;
  const double *positions = statics->equilibrium.state->positions;
  double more = fem_gravity_share(model, time) - fem_gravity_share(model, statics->kept_time);
  double longest = 0, held = 0;
  statics->work_begin = fem_gravity_ramp_work(model, more, statics->kept_position);
  statics->work_end = fem_gravity_ramp_work(model, more, positions);
  for (int d = 0; d < model->driver_count; d++)
    for (int i = 0; i < model->drivers[d].dof_count; i++) {
      int dof = model->drivers[d].dofs[i];
      double way = positions[dof] - statics->kept_position[dof];
      longest = fmax(longest, fabs(way));
      statics->work_begin -= statics->kept_force[dof] * way;
      statics->work_end -= system->forces[dof] * way;
    }
  for (int i = 0; i < system->numbering.count; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    held -= statics->kept_force[dof] * (positions[dof] - statics->kept_position[dof]);
  }
  statics->driven_work += 0.5 * (statics->work_begin + statics->work_end + held);
  statics->work_left = statics->residual * sqrt(system->numbering.count) * longest;
  statics->kept_time = time;
  size_t bytes = 3 * (size_t)model->vertex_count * sizeof(double);
  memcpy(statics->kept_force, system->forces, bytes);
  memcpy(statics->kept_position, positions, bytes);
}

// A state that turns an element inside out is no equilibrium of a body. The linear law knows no deformed
// state.
static Status check_orientation(const FemStatics *statics, double time) {
  const FemModel *model = statics->equilibrium.system->model;
  const double *positions = statics->equilibrium.state->positions;
  for (int e = 0; e < model->tet_count; e++) {
    const FemModelBody *body = &model->bodies[model->tet_body[e]];
    if (body->is_obstacle || fem_model_law(model, e) == FEM_MATERIAL_LINEAR) continue;
    double J = fem_model_det(model, e, positions);
    if (J > 0) continue;
    const double *x = positions + 3 * (size_t)model->tets[e][0];
    return status_fail(STATUS_RETRY,
                       "no equilibrium at t = %.9g: forces balance only with element %d of body '%s' "
                       "inverted, det F = %.3g, at (%.4g, %.4g, %.4g): %s",
                       time, e, body->name, J, x[0], x[1], x[2], fem_material_limit(fem_model_law(model, e)));
  }
  return STATUS_OK;
}

static Status find_equilibrium(FemStatics *statics, double time, double *u) {
  FemEquilibrium *equilibrium = &statics->equilibrium;
  size_t bytes = (size_t)equilibrium->system->numbering.count * sizeof *u;
  Status status = evaluate(statics, time, u);
  if (!status) status = newton(statics, time, u);
  if (status == STATUS_RETRY) {
    memcpy(u, statics->start, bytes);
    status = relax(statics, time, u);
    if (!status) status = newton(statics, time, u);
    if (status == STATUS_RETRY) status = say_why(statics, time, u);
  }
  if (!status) status = evaluate(statics, time, u);
  return status ? status : check_orientation(statics, time);
}

Status fem_statics_continue(FemStatics *statics, double time, const double *u, double force_scale,
                            double driven_work) {
  statics->force_scale = fmax(statics->force_scale, force_scale);
  TRY(evaluate(statics, time, u));
  statics->residual = fem_equilibrium_largest(statics->force, statics->equilibrium.system->numbering.count);
  keep_work(statics, time);
  statics->driven_work = driven_work;
  return STATUS_OK;
}

// Rigid motions that nothing hinders have eigenvalues of zero, which rounding may make negative. Pencil of K
// and M: rounding is DBL_EPSILON · 12 (L/h)² of E/(ρ L²), 3e-11 of it with a hundred elements in a row; forces
// that balance to 1e-6 add that share of the strain. A column's are (b/L)² of it, 1e-6 if a thousand times as
// long as wide.
static const double NEUTRAL = 1e-7;

// The sign of K's eigenvalues at the equilibrium that was found last.
static Status watch_stability(FemStatics *statics, double from, double to, const double *u) {
  FemEquilibrium *equilibrium = &statics->equilibrium;
  FemStability *stability = &statics->stability;
  long long failures = equilibrium->ops->stats(equilibrium->solver)->failed_factorisations;
  bool is_doubtful = failures > statics->failures;
  if (is_doubtful) {
    double shift = NEUTRAL * fem_equilibrium_first_shift(equilibrium);
    Status status = fem_equilibrium_factorise(equilibrium, to, u, shift);
    if (status < 0) return status;
    int count = -1;
    if (status == STATUS_RETRY) {
      if (equilibrium->ops->count_negative)
        (void)equilibrium->ops->count_negative(&equilibrium->system->matrix, &count);
      if (stability->unstable++ == 0) stability->stable_until = from, stability->unstable_from = to;
      if (count > stability->most || stability->unstable == 1) stability->most = count;
    }
  }
  statics->failures = equilibrium->ops->stats(equilibrium->solver)->failed_factorisations;
  return STATUS_OK;
}

Status fem_statics_step(FemStatics *statics, double from, double to, double *u) {
  FemEquilibrium *equilibrium = &statics->equilibrium;
  int n = equilibrium->system->numbering.count;
  memcpy(statics->start, u, (size_t)n * sizeof *u);
  Status status = find_equilibrium(statics, to, u);
  if (status == STATUS_OK) {
    statics->residual = fem_equilibrium_largest(statics->force, n);
    statics->steps++;
    statics->loose += statics->residual > statics->tolerance * statics->force_scale;
    TRY(fem_effect_loads_change(equilibrium->system, equilibrium->state, &statics->load_change));
    keep_work(statics, to);
    TRY(watch_stability(statics, from, to, u));
    return fem_system_accept(equilibrium->system, equilibrium->state, 0);
  }
  memcpy(u, statics->start, (size_t)n * sizeof *u);
  if (status < 0) return status;
  char why[1024];
  snprintf(why, sizeof why, "%s", status_message());
  statics->halvings++;
  TRY(fem_equilibrium_renew(equilibrium, from, u));
  return status_fail(STATUS_RETRY, "%s", why);
}
