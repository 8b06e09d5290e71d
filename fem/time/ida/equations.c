// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/equations.h"

#include <ida/ida.h>
#include <math.h>

#include "fem/effect/contact/contact.h"
#include "fem/sparse/vector.h"

int fem_ida_equations_residual(sunrealtype time, N_Vector y, N_Vector y_dot, N_Vector r, void *self) {
  FemIda *ida = self;
  FemSystem *system = ida->system;
  const FemPart *part = &ida->part;
  int n = ida->n;
  const double *v = fem_ida_values(y) + n, *u_dot = fem_ida_values(y_dot), *v_dot = u_dot + n;
  const double *masses = fem_ida_solver_masses(ida->solver);
  double *kinematics = fem_ida_values(r), *balance = kinematics + n;
  N_VScale(1, y, ida->evaluated);
  ida->evaluated_time = time;
  fem_ida_scatter(ida, time, y);
  int answer = fem_ida_failure_answer(&ida->failure, fem_system_forces(system, ida->state));
  if (answer != 0) return answer;
#pragma omp parallel for schedule(static) if (n > FEM_VECTOR_LONG)
  for (int i = 0; i < n; i++) {
    kinematics[i] = u_dot[i] - v[i];
    balance[i] = masses[i] * v_dot[i] - system->forces[fem_part_dof(part, i)];
  }
  return 0;
}

int fem_ida_equations_jacobian(sunrealtype time, sunrealtype c, N_Vector y, N_Vector y_dot, N_Vector r,
                               SUNMatrix matrix, void *self, N_Vector scratch1, N_Vector scratch2,
                               N_Vector scratch3) {
  (void)y_dot, (void)r, (void)matrix, (void)scratch1, (void)scratch2, (void)scratch3;
  FemIda *ida = self;
  fem_ida_scatter(ida, time, y);
  Status status = fem_ida_solver_assemble(ida->solver, ida->state, c);
  return fem_ida_failure_answer(&ida->failure, status);
}

int fem_ida_equations_weights(N_Vector y, N_Vector weights, void *self) {
  const FemIda *ida = self;
  FemErrorTolerance tolerance = ida->tolerance;
  tolerance.velocity *= ida->strictness;
  tolerance.speed_share *= ida->strictness;
  fem_error_weights(&tolerance, ida->system->model, &ida->part, ida->groups, fem_ida_values(y) + ida->n,
                    ida->group_speeds, fem_ida_values(weights));
  return 0;
}

static const double *right_of(void *self) {
  return fem_ida_solver_right(((FemIda *)self)->solver);
}

static void aim(void *self, double tolerance) {
  FemIda *ida = self;
  double c = 0;
  IDAGetCurrentCj(ida->memory, &c);
  fem_ida_solver_aim(ida->solver, c, tolerance);
}

static double unbalance(void *self, const double *balance) {
  FemIda *ida = self;
  const ContactEvaluation *contact;
  if (fem_effect_contact_evaluate(ida->system, ida->state, &contact)) return INFINITY;
  const FemSystem *system = ida->system;
  return fem_balance_excess(&ida->balance, system->model, &ida->part, ida->state, system->forces,
                            contact ? contact->given_forces : NULL, balance);
}

FemNewtonUser fem_ida_equations_user(FemIda *ida) {
  return (FemNewtonUser){.self = ida, .n = ida->n, .right = right_of, .unbalance = unbalance, .aim = aim};
}
