// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/cg.h"

#include <math.h>

#include "base/memory.h"
#include "base/ranks.h"

enum { PIECE = 1024, PARALLEL_SIZE = 4000 };

Status fem_cg_create(FemCg *cg, int size) {
  size_t n = (size_t)size;
  *cg = (FemCg){.size = size};
  double **vectors[] = {&cg->residual, &cg->direction, &cg->image, &cg->preconditioned};
  for (int i = 0; i < 4; i++)
    if (!(*vectors[i] = memory_zeroed(n, sizeof(double)))) return status_no_memory("conjugate gradients");
  cg->partial = memory_zeroed(n / PIECE + 1, sizeof *cg->partial);
  return cg->partial ? STATUS_OK : status_no_memory("conjugate gradients");
}

void fem_cg_destroy(FemCg *cg) {
  memory_free(cg->residual), memory_free(cg->direction), memory_free(cg->image);
  memory_free(cg->preconditioned), memory_free(cg->partial);
  *cg = (FemCg){0};
}

static double dot(FemCg *cg, const double *a, const double *b) {
  int pieces = (cg->size + PIECE - 1) / PIECE;
#pragma omp parallel for schedule(static) if (cg->size > PARALLEL_SIZE)
  for (int p = 0; p < pieces; p++) {
    int end = p + 1 < pieces ? (p + 1) * PIECE : cg->size;
    double sum = 0;
    for (int i = p * PIECE; i < end; i++) sum += a[i] * b[i];
    cg->partial[p] = sum;
  }
  double sum = 0;
  for (int p = 0; p < pieces; p++) sum += cg->partial[p];
  return sum;
}

// y += a x
static void add_scaled(int size, double a, const double *x, double *y) {
#pragma omp parallel for simd schedule(static) if (size > PARALLEL_SIZE)
  for (int i = 0; i < size; i++) y[i] += a * x[i];
}

Status fem_cg_solve(FemCg *cg, const FemCgProblem *problem, const double *b, double *x, long long *iterations,
                    FemCgEnd *end) {
  double *r = cg->residual, *p = cg->direction, *Ap = cg->image, *z = cg->preconditioned;
  int size = cg->size;
  *end = FEM_CG_CONVERGED;
  for (int i = 0; i < size; i++) x[i] = 0, r[i] = b[i];
  TRY(problem->precondition(problem->self, r, z));
  for (int i = 0; i < size; i++) p[i] = z[i];
  double rz = dot(cg, r, z);
  if (rz == 0) return STATUS_OK; // b = 0
  double goal = problem->tolerance * problem->tolerance * (problem->by_residual ? dot(cg, b, b) : rz);
  for (int k = 0; k < problem->limit; k++) {
    fem_matrix_multiply(problem->matrix, p, Ap);
    if (problem->matrix->share) ranks()->sum(Ap, (size_t)size);
    double pAp = dot(cg, p, Ap);
    *end = FEM_CG_INDEFINITE;
    if (!(pAp > 0) || isinf(pAp) || !(rz > 0))
      return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite (found by %s)",
                         problem->name);
    double step = rz / pAp;
    add_scaled(size, step, p, x);
    add_scaled(size, -step, Ap, r);
    ++*iterations;
    *end = FEM_CG_CONVERGED;
    if (problem->by_residual && dot(cg, r, r) <= goal) return STATUS_OK;
    TRY(problem->precondition(problem->self, r, z));
    double rz_next = dot(cg, r, z);
    if (!problem->by_residual && fabs(rz_next) <= goal) return STATUS_OK;
    double ratio = rz_next / rz;
    for (int i = 0; i < size; i++) p[i] = z[i] + ratio * p[i];
    rz = rz_next;
  }
  *end = FEM_CG_LIMIT;
  return status_fail(
      STATUS_RETRY,
      "%s did not converge in %d iterations: use solver.linear: cholmod, or a larger solver.tolerance",
      problem->name, problem->limit);
}
