// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/start.h"

#include <math.h>

#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/sparse/vector.h"
#include "fem/time/ida/equations.h"

Status fem_ida_start_derivatives(FemIda *ida, double time) {
  FemSystem *system = ida->system;
  const FemPart *part = &ida->part;
  int n = ida->n;
  const double *u = fem_ida_values(ida->y), *v = u + n;
  const double *masses = fem_ida_solver_masses(ida->solver);
  double *u_dot = fem_ida_values(ida->y_dot), *v_dot = u_dot + n;
  if (ranks_any(!fem_vector_is_finite(2 * n, u)))
    return status_fail(STATUS_SOLVER, "at t = %g s: a position or velocity is not a number", time);
  fem_ida_scatter(ida, time, ida->y);
  TRY(fem_system_forces(system, ida->state));
  for (int i = 0; i < n; i++) {
    u_dot[i] = v[i];
    v_dot[i] = system->forces[fem_part_dof(part, i)] / masses[i];
  }
  if (!ranks_any(!fem_vector_is_finite(n, v_dot))) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "at t = %g s: an acceleration is not a number", time);
}

// IDA's own first step: a thousandth of the way to the end, or what changes the state by half of the
// tolerances where that is shorter (SUNDIALS, IDASolve).
static const double START_SHARE = 1e-3, START_CHANGE = 0.5; // not chosen: IDA's own

// ‖ẏ‖ in the norm of the error test, without the velocity that nothing can notice.
static double rate_of_change(FemIda *ida, bool *has_common) {
  const FemModel *model = ida->system->model;
  N_Vector rates = ida->interpolated;
  double common[3];
  vec3_store(common, fem_error_weights_common(model, &ida->part, fem_ida_values(ida->y) + ida->n));
  *has_common = vec3_length(vec3_at(common)) > 0;
  N_VScale(1, ida->y_dot, rates);
  for (int i = 0; i < ida->n && *has_common; i++)
    fem_ida_values(rates)[i] -= common[fem_part_dof(&ida->part, i) % 3];
  fem_ida_equations_weights(ida->y, ida->weights, ida);
  return N_VWrmsNorm(rates, ida->weights);
}

double fem_ida_start_step(FemIda *ida, double time, double end, double shortest) {
  bool has_common;
  const double longest = START_SHARE * (end - time), least = fmin(shortest, longest),
               rate = rate_of_change(ida, &has_common);
  if (least > 0 && rate * least > START_CHANGE) return least;
  if (!has_common) return 0;
  return rate * longest > START_CHANGE ? START_CHANGE / rate : longest;
}
