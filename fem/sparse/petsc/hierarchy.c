// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/petsc/hierarchy.h"

#include "base/memory.h"

// Matrices of PETSc, the coarsest first, and their rows, the finest first.
typedef struct Taken {
  PetscInt level_count, operator_count; // levels that there are interpolations and matrices of; equal
  Mat *matrices,
      *interpolations;  // of all levels but the finest; from all levels but that    (level_count − 1)
  FemRows *rows, *maps; // of the same; rows[0] is the finest level's   (level_count), (level_count)
} Taken;

#define PETSC_TRY(call)                                                                                      \
  do {                                                                                                       \
    *code = (call);                                                                                          \
    if (*code) return status_fail(STATUS_SOLVER, "amg: PETSc's error %d", (int)*code);                       \
  } while (0)

static Status open_rows(const FemPetscLibrary *petsc, Mat matrix, int column_count, FemRows *rows,
                        PetscErrorCode *code) {
  PetscInt count;
  const PetscInt *begin, *column;
  const PetscScalar *value;
  PetscBool is_done = PETSC_FALSE;
  PETSC_TRY(petsc->MatGetRowIJ(matrix, 0, PETSC_FALSE, PETSC_FALSE, &count, &begin, &column, &is_done));
  PETSC_TRY(is_done ? 0 : PETSC_ERR_SUP);
  *rows = (FemRows){count, column_count, begin, column, NULL};
  PETSC_TRY(petsc->MatSeqAIJGetArrayRead(matrix, &value));
  rows->value = value;
  return STATUS_OK;
}

static void close_rows(const FemPetscLibrary *petsc, Mat matrix, const FemRows *rows) {
  PetscInt count = rows->count;
  const PetscInt *begin = rows->begin, *column = rows->column;
  const PetscScalar *value = rows->value;
  PetscBool is_done;
  if (value) petsc->MatSeqAIJRestoreArrayRead(matrix, &value);
  if (begin) petsc->MatRestoreRowIJ(matrix, 0, PETSC_FALSE, PETSC_FALSE, &count, &begin, &column, &is_done);
}

static Status take(const FemPetscLibrary *petsc, PC multigrid, const FemRows *finest, Taken *taken,
                   PetscErrorCode *code) {
  PETSC_TRY(petsc->PCGetInterpolations(multigrid, &taken->level_count, &taken->interpolations));
  PETSC_TRY(petsc->PCGetCoarseOperators(multigrid, &taken->operator_count, &taken->matrices));
  const PetscInt count = taken->level_count;
  PETSC_TRY(count == taken->operator_count ? 0 : PETSC_ERR_PLIB);
  taken->rows = memory_zeroed((size_t)count, sizeof *taken->rows);
  taken->maps = memory_zeroed((size_t)count, sizeof *taken->maps);
  if (!taken->rows || !taken->maps) return status_no_memory("the multigrid of the condensed system");
  taken->rows[0] = *finest;
  for (int l = 1; l < count; l++) {
    TRY(open_rows(petsc, taken->matrices[count - 1 - l], 0, &taken->rows[l], code));
    taken->rows[l].column_count = taken->rows[l].count;
  }
  for (int l = 0; l + 1 < count; l++)
    TRY(open_rows(petsc, taken->interpolations[count - 2 - l], taken->rows[l + 1].count, &taken->maps[l],
                  code));
  return STATUS_OK;
}

static void give_back(const FemPetscLibrary *petsc, Taken *taken) {
  const int count = (int)taken->level_count;
  for (int l = 1; l < count; l++) {
    if (taken->rows) close_rows(petsc, taken->matrices[count - 1 - l], &taken->rows[l]);
    if (taken->maps) close_rows(petsc, taken->interpolations[count - 1 - l], &taken->maps[l - 1]);
  }
  for (int l = 0; l + 1 < count; l++) petsc->MatDestroy(&taken->interpolations[l]);
  for (int l = 0; l + 1 < (int)taken->operator_count; l++) petsc->MatDestroy(&taken->matrices[l]);
  if (taken->matrices) petsc->release(taken->matrices, __LINE__, __func__, __FILE__);
  if (taken->interpolations) petsc->release(taken->interpolations, __LINE__, __func__, __FILE__);
  memory_free(taken->rows), memory_free(taken->maps);
}

Status fem_hierarchy_take(const FemPetscLibrary *petsc, PC multigrid, const FemRows *finest, FemCycle *cycle,
                          PetscErrorCode *code) {
  Taken taken = {0};
  *code = 0;
  Status status = take(petsc, multigrid, finest, &taken, code);
  if (!status) status = fem_cycle_create(cycle, taken.level_count, taken.rows, taken.maps);
  give_back(petsc, &taken);
  return status;
}
