// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/memory.h"

#include <ida/ida.h>
#include <math.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/limits.h"
#include "fem/time/ida/equations.h"
#include "fem/time/nvector.h"
#include "fem/time/sundials.h"

// Without contact a step is lengthened only if it can double (IDA's own), which saves factorisations.
static const double LEAST_GROWTH_WITHOUT_CONTACT = 2;

static Status create_vectors(FemIda *ida) {
  TRY(fem_part_create(&ida->part, ida->system->model, &ida->system->numbering));
  ida->n = ida->part.count;
  if (!fem_sundials_create(&ida->context)) return status_no_memory("the integrator");
  N_Vector *vectors[] = {&ida->y, &ida->y_dot, &ida->interpolated, &ida->evaluated, &ida->weights};
  for (int i = 0; i < 5; i++) {
    *vectors[i] = fem_nvector_create(2 * ida->n, ida->context); // IDA's own ones are clones
    if (!*vectors[i]) return status_no_memory("the integrator");
  }
  return STATUS_OK;
}

// After so many failures in a row the longest step has become the shortest: from the third on each cuts it to
// a quarter at least.
static int most_failures(const FemIdaDef *def) {
  return 2 + (int)ceil(0.5 * log2(def->max_step / def->min_step));
}

static Status configure(FemIda *self, const FemIdaDef *def) {
  void *ida = self->memory = IDACreate(self->context);
  if (!ida) return status_no_memory("the integrator");
  bool has_contact = fem_system_effect(self->system, &fem_effect_contact);
  int failures = most_failures(def);
  double least_growth = has_contact ? FEM_LEAST_GROWTH : LEAST_GROWTH_WITHOUT_CONTACT;
  bool is_ok = FEM_SUNDIALS_SILENCE(IDA, ida) &&
               IDASetMaxOrd(ida, def->max_order) == IDA_SUCCESS && // before vectors are made for more
               IDAInit(ida, fem_ida_equations_residual, 0, self->y, self->y_dot) == IDA_SUCCESS &&
               IDAWFtolerances(ida, fem_ida_equations_weights) == IDA_SUCCESS &&
               IDASetUserData(ida, self) == IDA_SUCCESS && fem_ida_solver_attach(self->solver, ida) &&
               IDASetJacFn(ida, fem_ida_equations_jacobian) == IDA_SUCCESS &&
               IDASetNonlinearSolver(ida, self->newton.solver) == IDA_SUCCESS &&
               IDASetMaxStep(ida, def->max_step) == IDA_SUCCESS &&
               IDASetMinStep(ida, def->min_step) == IDA_SUCCESS &&
               IDASetEtaFixedStepBounds(ida, 1, least_growth) == IDA_SUCCESS &&
               IDASetMaxErrTestFails(ida, failures) == IDA_SUCCESS &&
               IDASetMaxConvFails(ida, failures) == IDA_SUCCESS && IDASetMaxNumSteps(ida, -1) == IDA_SUCCESS;
  return is_ok ? STATUS_OK : status_fail(STATUS_SOLVER, "IDA could not be set up");
}

Status fem_ida_memory_create(FemIda *ida, const FemIdaDef *def) {
  *ida = (FemIda){.system = def->system, .state = def->state, .tolerance = def->tolerance, .strictness = 1};
  TRY(create_vectors(ida));
  TRY(fem_ida_solver_create(&ida->solver, ida->system, &ida->part, def->solver,
                            FEM_ROUNDING * def->tolerance.velocity, &ida->failure, ida->context));
  const size_t bodies = (size_t)ida->system->model->body_count;
  ida->group_speeds = memory_zeroed(bodies, sizeof *ida->group_speeds);
  if (!ida->group_speeds) return status_no_memory("the integrator");
  TRY(fem_balance_create(&ida->balance, ida->system->model->body_count));
  FemNewtonUser user = fem_ida_equations_user(ida);
  TRY(fem_newton_create(&ida->newton, &user, ida->y, ida->context));
  return configure(ida, def);
}

void fem_ida_memory_destroy(FemIda *ida) {
  if (ida->memory) IDAFree(&ida->memory);
  fem_newton_destroy(&ida->newton);
  fem_balance_destroy(&ida->balance);
  memory_free(ida->group_speeds);
  fem_part_destroy(&ida->part);
  fem_ida_solver_destroy(ida->solver);
  N_Vector vectors[] = {ida->y, ida->y_dot, ida->interpolated, ida->evaluated, ida->weights};
  for (int i = 0; i < 5; i++)
    if (vectors[i]) N_VDestroy(vectors[i]);
  if (ida->context) SUNContext_Free(&ida->context);
}
