// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/statics/equilibrium.h"

#include <math.h>

Status fem_equilibrium_create(FemEquilibrium *equilibrium, FemSystem *system, FemState *state,
                              const FemSolverOps *ops) {
  *equilibrium = (FemEquilibrium){.system = system, .state = state, .ops = ops};
  if (!ops->is_condensed)
    return status_fail(STATUS_INPUT,
                       "solver.linear: %s solves motions only; write cholmod, amg or pcg for a static scene",
                       ops->name);
  const FemSceneDef *scene = system->model->scene;
  Status status =
      ops->create(&equilibrium->solver, scene->threads, fem_solver_tolerance(ops, scene->solver_tolerance));
  if (status) fem_equilibrium_destroy(equilibrium);
  return status;
}

void fem_equilibrium_destroy(FemEquilibrium *equilibrium) {
  if (equilibrium->solver) equilibrium->ops->destroy(equilibrium->solver);
  *equilibrium = (FemEquilibrium){0};
}

Status fem_equilibrium_renew(FemEquilibrium *equilibrium, double time, const double *u) {
  fem_system_scatter(equilibrium->system, time, u, NULL, equilibrium->state);
  return fem_system_renew(equilibrium->system, equilibrium->state);
}

Status fem_equilibrium_forces_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                     const double *v, double *force) {
  FemSystem *system = equilibrium->system;
  fem_system_scatter(system, time, u, v, equilibrium->state);
  TRY(fem_system_forces(system, equilibrium->state));
  const FemNumbering *numbering = &system->numbering;
  for (int i = 0; i < numbering->count; i++) force[i] = system->forces[numbering->dof_of_unknown[i]];
  return STATUS_OK;
}

Status fem_equilibrium_forces(FemEquilibrium *equilibrium, double time, const double *u, double *force) {
  return fem_equilibrium_forces_moving(equilibrium, time, u, NULL, force);
}

Status fem_equilibrium_assemble_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                       const double *v, double damping, double shift) {
  FemSystem *system = equilibrium->system;
  fem_system_scatter(system, time, u, v, equilibrium->state);
  TRY(fem_system_couple(system, equilibrium->state));
  return fem_system_assemble(system, equilibrium->state, 1, damping, shift, &system->matrix);
}

Status fem_equilibrium_factorise_assembled(FemEquilibrium *equilibrium) {
  FemSystem *system = equilibrium->system;
  if (equilibrium->layout != system->matrix.layout) {
    TRY(equilibrium->ops->analyse(equilibrium->solver, &system->matrix));
    equilibrium->layout = system->matrix.layout;
  }
  return equilibrium->ops->factorise(equilibrium->solver, &system->matrix, NULL, NULL, 0);
}

Status fem_equilibrium_factorise_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                        const double *v, double damping, double shift) {
  TRY(fem_equilibrium_assemble_moving(equilibrium, time, u, v, damping, shift));
  return fem_equilibrium_factorise_assembled(equilibrium);
}

Status fem_equilibrium_factorise(FemEquilibrium *equilibrium, double time, const double *u, double shift) {
  return fem_equilibrium_factorise_moving(equilibrium, time, u, NULL, 0, shift);
}

Status fem_equilibrium_solve(FemEquilibrium *equilibrium, const double *b, double *x) {
  return equilibrium->ops->solve(equilibrium->solver, b, x);
}

double fem_equilibrium_largest(const double *values, int count) {
  double largest = 0;
  for (int i = 0; i < count; i++) largest = fmax(largest, fabs(values[i]));
  return largest;
}

double fem_equilibrium_longest_share(const FemEquilibrium *equilibrium, const double *step) {
  static const double LONGEST_WAY = 0.25;
  double way = fem_equilibrium_largest(step, equilibrium->system->numbering.count);
  double most = LONGEST_WAY * equilibrium->system->model->edge;
  return way > most ? most / way : 1;
}

double fem_equilibrium_first_shift(const FemEquilibrium *equilibrium) {
  const FemModel *model = equilibrium->system->model;
  double shift = INFINITY;
  for (int p = 0; p < model->part_count; p++)
    shift = fmin(shift, model->parts[p].material.young / model->parts[p].material.density);
  return shift / (model->length * model->length);
}
