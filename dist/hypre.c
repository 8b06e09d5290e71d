// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/hypre.h"

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <assert.h>
#include <petscmathypre.h>
#include <stdbool.h>

#include "base/memory.h"

static_assert(sizeof(HYPRE_BigInt) == sizeof(int), "hypre numbers rows by int");

struct DistHypre {
  HYPRE_IJMatrix rows;
};

static Status fail(void) {
  bool is_memory = HYPRE_CheckError(HYPRE_GetError(), HYPRE_ERROR_MEMORY);
  HYPRE_ClearAllErrors();
  return is_memory ? status_no_memory("the multigrid's matrix")
                   : status_fail(STATUS_SOLVER, "hypre refused the matrix");
}

#define HYPRE_TRY(call)                                                                                      \
  do {                                                                                                       \
    if (call) return fail();                                                                                 \
  } while (0)

static Status begin(HYPRE_IJMatrix *rows, MPI_Comm world, int first, int end, const int *own,
                    const int *others) {
  HYPRE_TRY(HYPRE_Init());
  HYPRE_TRY(HYPRE_IJMatrixCreate(world, first, end - 1, first, end - 1, rows));
  HYPRE_TRY(HYPRE_IJMatrixSetObjectType(*rows, HYPRE_PARCSR));
  HYPRE_TRY(HYPRE_IJMatrixSetDiagOffdSizes(*rows, own, others));
  HYPRE_TRY(HYPRE_IJMatrixInitialize_v2(*rows, HYPRE_MEMORY_HOST));
  return STATUS_OK;
}

Status dist_hypre_create(DistHypre **matrix, MPI_Comm world, int first, int end, const int *own,
                         const int *others) {
  *matrix = memory_zeroed(1, sizeof **matrix);
  if (!*matrix) return status_no_memory("the multigrid's matrix");
  Status status = begin(&(*matrix)->rows, world, first, end, own, others);
  if (!status) return STATUS_OK;
  dist_hypre_destroy(*matrix);
  *matrix = NULL;
  return status;
}

void dist_hypre_destroy(DistHypre *matrix) {
  if (matrix && matrix->rows) HYPRE_IJMatrixDestroy(matrix->rows);
  memory_free(matrix);
}

Status dist_hypre_set_row(DistHypre *matrix, int row, int count, const int *columns, const double *values) {
  HYPRE_TRY(HYPRE_IJMatrixSetValues(matrix->rows, 1, &count, &row, columns, values));
  return STATUS_OK;
}

Status dist_hypre_end(DistHypre *matrix, Mat *view) {
  void *object;
  HYPRE_TRY(HYPRE_IJMatrixAssemble(matrix->rows));
  HYPRE_TRY(HYPRE_IJMatrixGetObject(matrix->rows, &object));
  PetscErrorCode code = MatCreateFromParCSR(object, MATHYPRE, PETSC_USE_POINTER, view);
  return code ? status_fail(STATUS_SOLVER, "PETSc refused hypre's matrix with error %d", (int)code)
              : STATUS_OK;
}
