// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/inverse.h"

#include "base/memory.h"
#include "fem/gradient/path/dominance.h"

enum { MOST_ITERATIONS = 100 }; // where mass dominates ten leave 1e-8

static Status create_factor(FemInverse *inverse, FemSystem *system, FemState *state) {
  TRY(fem_equilibrium_create(&inverse->equilibrium, system, state, &fem_solver_cholmod));
  fem_solver_cholmod.be_rough(inverse->equilibrium.solver);
  return STATUS_OK;
}

Status fem_inverse_create(FemInverse *inverse, FemSystem *system, FemState *state) {
  *inverse = (FemInverse){0};
  TRY(create_factor(inverse, system, state));
  inverse->diagonal = memory_zeroed((size_t)system->numbering.count, sizeof *inverse->diagonal);
  if (!inverse->diagonal) return status_no_memory("the replay of a run");
  return fem_cg_create(&inverse->cg, system->numbering.count);
}

void fem_inverse_destroy(FemInverse *inverse) {
  fem_equilibrium_destroy(&inverse->equilibrium);
  fem_cg_destroy(&inverse->cg);
  memory_free(inverse->diagonal);
  *inverse = (FemInverse){0};
}

// A solver keeps its order of elimination, so one which goes on adds up otherwise than one which begins.
Status fem_inverse_forget(FemInverse *inverse) {
  FemSystem *system = inverse->equilibrium.system;
  FemState *state = inverse->equilibrium.state;
  inverse->is_made = false;
  if (inverse->equilibrium.layout == 0) return STATUS_OK;
  fem_equilibrium_destroy(&inverse->equilibrium);
  return create_factor(inverse, system, state);
}

// S with another c, but for D.
static void shift(FemInverse *inverse, double c) {
  FemSystem *system = inverse->equilibrium.system;
  FemMatrix *matrix = &system->matrix;
  fem_matrix_add_mass(matrix, system->model->mass, (c - inverse->c) * (c + inverse->c));
  for (int i = 0; i < matrix->size; i++) inverse->diagonal[i] = matrix->value[matrix->col_begin[i]];
  inverse->c = c;
}

Status fem_inverse_make(FemInverse *inverse, double time, const double *u, const double *v, double c) {
  FemEquilibrium *equilibrium = &inverse->equilibrium;
  inverse->is_made = false;
  TRY(fem_equilibrium_assemble_moving(equilibrium, time, u, v, c, 0));
  inverse->least =
      fem_dominance_least(equilibrium->system, &equilibrium->system->matrix, NULL, inverse->diagonal);
  inverse->is_light = c > 0 && c >= inverse->least;
  inverse->c = 0;
  shift(inverse, c);
  if (!inverse->is_light) TRY(fem_equilibrium_factorise_assembled(equilibrium));
  inverse->is_made = true;
  return STATUS_OK;
}

bool fem_inverse_serves(const FemInverse *inverse, double c) {
  return inverse->is_made && (!inverse->is_light || c >= inverse->least);
}

static Status divide(void *self, const double *r, double *z) {
  const FemInverse *inverse = self;
  for (int i = 0; i < inverse->cg.size; i++) z[i] = r[i] / inverse->diagonal[i];
  return STATUS_OK;
}

Status fem_inverse_solve(FemInverse *inverse, double c, double tolerance, const double *b, double *x) {
  if (!inverse->is_light) return fem_equilibrium_solve(&inverse->equilibrium, b, x);
  FemCgProblem problem = {.matrix = &inverse->equilibrium.system->matrix,
                          .precondition = divide,
                          .self = inverse,
                          .name = "conjugate gradients",
                          .tolerance = tolerance,
                          .by_residual = true,
                          .limit = MOST_ITERATIONS};
  long long iterations = 0;
  FemCgEnd end;
  if (c != inverse->c) shift(inverse, c);
  return fem_cg_solve(&inverse->cg, &problem, b, x, &iterations, &end);
}
