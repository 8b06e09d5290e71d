// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/cg.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "fem/sparse/vector.h"

Status fem_cg_create(FemCg *cg, int size) {
  size_t n = (size_t)size;
  *cg = (FemCg){.size = size};
  double **vectors[] = {&cg->residual, &cg->direction, &cg->image, &cg->preconditioned};
  for (int i = 0; i < 4; i++)
    if (!(*vectors[i] = memory_zeroed(n, sizeof(double)))) return status_no_memory("conjugate gradients");
  return STATUS_OK;
}

void fem_cg_destroy(FemCg *cg) {
  memory_free(cg->residual), memory_free(cg->direction), memory_free(cg->image);
  memory_free(cg->preconditioned);
  *cg = (FemCg){0};
}

Status fem_cg_solve(FemCg *cg, const FemCgProblem *problem, const double *b, double *x, long long *iterations,
                    FemCgEnd *end) {
  double *r = cg->residual, *p = cg->direction, *Ap = cg->image, *z = cg->preconditioned;
  int size = cg->size;
  *end = FEM_CG_CONVERGED;
  fem_vector_fill(size, 0, x);
  fem_vector_copy(size, b, r);
  TRY(problem->precondition(problem->self, r, z));
  fem_vector_copy(size, z, p);
  double rz = fem_vector_dot(size, r, z);
  if (rz == 0) return STATUS_OK; // b = 0
  double goal =
      problem->tolerance * problem->tolerance * (problem->by_residual ? fem_vector_dot(size, b, b) : rz);
  for (int k = 0; k < problem->limit; k++) {
    fem_matrix_multiply(problem->matrix, p, Ap);
    if (problem->matrix->share) ranks()->sum(Ap, (size_t)size);
    double pAp = fem_vector_dot(size, p, Ap);
    *end = FEM_CG_INDEFINITE;
    if (!(pAp > 0) || isinf(pAp) || !(rz > 0))
      return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite (found by %s)",
                         problem->name);
    double step = rz / pAp;
    fem_vector_sum(size, 1, x, step, p, x);
    fem_vector_sum(size, 1, r, -step, Ap, r);
    ++*iterations;
    *end = FEM_CG_CONVERGED;
    if (problem->by_residual && fem_vector_dot(size, r, r) <= goal) return STATUS_OK;
    TRY(problem->precondition(problem->self, r, z));
    double rz_next = fem_vector_dot(size, r, z);
    if (!problem->by_residual && fabs(rz_next) <= goal) return STATUS_OK;
    double ratio = rz_next / rz;
    fem_vector_sum(size, 1, z, ratio, p, p);
    rz = rz_next;
  }
  *end = FEM_CG_LIMIT;
  return status_fail(
      STATUS_RETRY,
      "%s did not converge in %d iterations: use solver.linear: cholmod, or a larger solver.tolerance",
      problem->name, problem->limit);
}
