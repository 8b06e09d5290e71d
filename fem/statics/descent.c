// SPDX-License-Identifier: GPL-3.0-or-later
// The line search is that of Matthies and Strang (1979): a step d from u is as long as f(u + s d)·d has at
// most a share of f(u)·d. It needs no potential, which friction does not have.
#include "fem/statics/descent.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/sparse/vector.h"

// A full step is taken if this share of the first work is left, and a search ends there.
static const double WORK_LEFT = 0.8, WORK_FOUND = 0.3;
// The ends of an edge move against each other no further at once than this share of its length at rest: where
// cells are small beside the rest of the mesh, a longer way would flatten them.
static const double LONGEST_STRETCH = 0.5;
// Where K is not positive definite, the first shift, as a share of (c/L)², and by what it rises and falls.
static const double FIRST_SHIFT = 1e-3, SHIFT_RISE = 10, SHIFT_FALL = 0.1;
enum { DESCENT_STEPS = 80, SHIFT_REFUSALS = 30, MAX_SEARCH = 8, MAX_HALVINGS = 8 };

typedef struct Descent {
  FemEquilibrium *equilibrium;
  double time, first_shift, shift;
  int n, refusals;
  double *u, *force;    // the caller's, and there
  double *step;         // d
  double *next, *there; // u + s d, and the force there
} Descent;

static Vec3 move_of(const FemNumbering *numbering, const double *step, int vertex) {
  double move[3];
  for (int c = 0; c < 3; c++) {
    int unknown = numbering->unknown_of_dof[3 * vertex + c];
    move[c] = unknown < 0 ? 0 : step[unknown];
  }
  return vec3_at(move);
}

// The largest way of an edge's ends against each other, over the edge at rest.
static double largest_stretch(const FemSystem *system, const double *step) {
  const FemModel *model = system->model;
  double square = 0;
  for (int t = 0; t < model->tet_count; t++)
    for (int v = 1; v < 4; v++)
      for (int w = 0; w < v; w++) {
        int a = model->tets[t][v], b = model->tets[t][w];
        Vec3 way = vec3_sub(move_of(&system->numbering, step, a), move_of(&system->numbering, step, b));
        Vec3 edge = vec3_sub(vec3_at(model->rest + 3 * (size_t)a), vec3_at(model->rest + 3 * (size_t)b));
        square = fmax(square, vec3_dot(way, way) / vec3_dot(edge, edge));
      }
  return sqrt(square);
}

// The share of d that a step may take at most.
static double longest_share(const Descent *descent) {
  double share = fem_equilibrium_longest_share(descent->equilibrium, descent->step);
  double stretch = largest_stretch(descent->equilibrium->system, descent->step);
  return fmin(share, stretch > LONGEST_STRETCH ? LONGEST_STRETCH / stretch : 1);
}

// d = (K + shift M)⁻¹ f; RETRY: the matrix is not positive definite. Of one that is singular to rounding a
// solver may not find that, but gives a d, most of it along what nothing holds, against which the force may
// do work.
static Status try_step(Descent *descent) {
  TRY(fem_equilibrium_factorise(descent->equilibrium, descent->time, descent->u, descent->shift));
  TRY(fem_equilibrium_solve(descent->equilibrium, descent->force, descent->step));
  if (fem_vector_dot(descent->n, descent->force, descent->step) > 0) return STATUS_OK;
  return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
}

// The shift such that the matrix is positive definite; d, no longer than the longest way and stretch.
static Status find_step(Descent *descent) {
  Status status = try_step(descent);
  while (status == STATUS_RETRY && descent->refusals++ < SHIFT_REFUSALS) {
    descent->shift = fmax(SHIFT_RISE * descent->shift, FIRST_SHIFT * descent->first_shift);
    status = try_step(descent);
  }
  TRY(status);
  double share = longest_share(descent);
  for (int i = 0; i < descent->n && share < 1; i++) descent->step[i] *= share;
  descent->shift = descent->shift > FIRST_SHIFT * descent->first_shift ? SHIFT_FALL * descent->shift : 0;
  return STATUS_OK;
}

// The work along the step that is left at u + s d.
static Status try_length(Descent *descent, double s, double *work) {
  for (int i = 0; i < descent->n; i++) descent->next[i] = descent->u[i] + s * descent->step[i];
  TRY(fem_equilibrium_forces(descent->equilibrium, descent->time, descent->next, descent->there));
  *work = fem_vector_dot(descent->n, descent->there, descent->step);
  return STATUS_OK;
}

// A length that can be evaluated: with new contact lists, if need be, and shorter.
static Status try_longest(Descent *descent, double *s, double *work) {
  Status status = try_length(descent, *s, work);
  if (status != STATUS_RETRY) return status;
  FemEquilibrium *equilibrium = descent->equilibrium;
  TRY(fem_equilibrium_forces(equilibrium, descent->time, descent->u, descent->there));
  TRY(fem_equilibrium_renew(equilibrium, descent->time, descent->u));
  for (int k = 0; k < MAX_HALVINGS; k++, *s *= 0.5)
    if ((status = try_length(descent, *s, work)) != STATUS_RETRY) return status;
  return status;
}

// Between 0, where the work is `first`, and `most`, where it has changed its sign: by the regula falsi that
// halves the value of an end that stays (Illinois).
static Status search(Descent *descent, double first, double most, double work) {
  double low = 0, low_work = first, high = most, high_work = work;
  for (int k = 0; k < MAX_SEARCH && fabs(work) > WORK_FOUND * first; k++) {
    double s = low + (high - low) * fmin(fmax(low_work / (low_work - high_work), 0.05), 0.95);
    TRY(try_length(descent, s, &work));
    if (work > 0) {
      low = s, low_work = work;
      high_work *= 0.5;
    } else {
      high = s, high_work = work;
      low_work *= 0.5;
    }
  }
  return STATUS_OK;
}

static Status iterate(Descent *descent) {
  double length = 1, work;
  TRY(find_step(descent));
  double first = fem_vector_dot(descent->n, descent->force, descent->step);
  TRY(try_longest(descent, &length, &work));
  if (work < -WORK_LEFT * first) TRY(search(descent, first, length, work));
  memcpy(descent->u, descent->next, (size_t)descent->n * sizeof *descent->u);
  memcpy(descent->force, descent->there, (size_t)descent->n * sizeof *descent->force);
  return STATUS_OK;
}

static Status descend(Descent *descent, double tolerance, long long *iterations) {
  FemEquilibrium *equilibrium = descent->equilibrium;
  TRY(fem_equilibrium_forces(equilibrium, descent->time, descent->u, descent->force));
  double left;
  for (int k = 0;; k++) {
    left = fem_equilibrium_largest(descent->force, descent->n);
    if (left <= (k < FEM_DESCENT_PATIENCE ? 1 : FEM_DESCENT_TOLERABLE) * tolerance) return STATUS_OK;
    if (k == DESCENT_STEPS) break;
    TRY(iterate(descent));
    ++*iterations;
  }
  return status_fail(
      STATUS_RETRY,
      "Newton's method left a force of %.3g times the tolerance after %d iterations with a line search",
      left / tolerance, DESCENT_STEPS);
}

Status fem_descent_solve(FemEquilibrium *equilibrium, double time, double tolerance, double *u,
                         long long *iterations) {
  int n = equilibrium->system->numbering.count;
  double *room = memory_zeroed(4 * (size_t)n, sizeof *room);
  if (!room) return status_no_memory("Newton's method");
  Descent descent = {.equilibrium = equilibrium,
                     .time = time,
                     .first_shift = fem_equilibrium_first_shift(equilibrium),
                     .n = n,
                     .u = u,
                     .force = room,
                     .step = room + n,
                     .next = room + 2 * n,
                     .there = room + 3 * n};
  Status status = descend(&descent, tolerance, iterations);
  memory_free(room);
  return status;
}
