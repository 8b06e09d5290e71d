// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/petsc/multigrid.h"

#include "base/memory.h"
#include "fem/sparse/petsc/hierarchy.h"

static const char *const names[] = {[FEM_PETSC_BOOMER] = "amg", [FEM_PETSC_GAMG] = "gamg"};
static const char *const prefixes[] = {[FEM_PETSC_BOOMER] = "tetlap_amg_", [FEM_PETSC_GAMG] = "tetlap_gamg_"};

const char *fem_petsc_multigrid_name(FemPetscKind kind) {
  return names[kind];
}

// Errors that a matrix can be the cause of, so that another one may do. hypre's are all of one kind.
static bool is_of_matrix(PetscErrorCode code) {
  return code == PETSC_ERR_MAT_LU_ZRPVT || code == PETSC_ERR_MAT_CH_ZRPVT || code == PETSC_ERR_FP ||
         code == PETSC_ERR_CONV_FAILED || code == PETSC_ERR_NOT_CONVERGED || code == PETSC_ERR_LIB;
}

static Status fail_in(const FemPetscMultigrid *multigrid, const char *what, PetscErrorCode code) {
  if (code == PETSC_ERR_MEM) return status_no_memory("the multigrid of the condensed system");
  return status_fail(is_of_matrix(code) ? STATUS_RETRY : STATUS_SOLVER,
                     "%s: %s failed with PETSc's error %d; solver.linear: cholmod does without PETSc",
                     names[multigrid->kind], what, (int)code);
}

#define PETSC_TRY(what, call)                                                                                \
  do {                                                                                                       \
    PetscErrorCode code_ = (call);                                                                           \
    if (code_) return fail_in(multigrid, what, code_);                                                       \
  } while (0)

// ---- Room.

const char *const fem_petsc_boomer_options[FEM_PETSC_BOOMER_OPTIONS][2] = {
    {"-tetlap_amg_pc_hypre_type", "boomeramg"},
    {"-tetlap_amg_pc_hypre_boomeramg_coarsen_type", "HMIS"},
    {"-tetlap_amg_pc_hypre_boomeramg_interp_type", "ext+i"},
    {"-tetlap_amg_pc_hypre_boomeramg_P_max", "4"},
    {"-tetlap_amg_pc_hypre_boomeramg_strong_threshold", "0.5"},
    {"-tetlap_amg_pc_hypre_boomeramg_agg_nl", "1"},
};

static Status set_option(const FemPetscMultigrid *multigrid, const char *name, const char *value) {
  PETSC_TRY(name, multigrid->petsc->PetscOptionsSetValue(NULL, name, value));
  return STATUS_OK;
}

// GAMG has its own smoother.
static Status set_options(const FemPetscMultigrid *multigrid) {
  for (int i = 0; i < FEM_PETSC_BOOMER_OPTIONS; i++)
    TRY(set_option(multigrid, fem_petsc_boomer_options[i][0], fem_petsc_boomer_options[i][1]));
  return set_option(multigrid, "-tetlap_gamg_pc_gamg_reuse_interpolation", "true");
}

Status fem_petsc_multigrid_open(FemPetscMultigrid *multigrid, FemPetscKind kind) {
  *multigrid = (FemPetscMultigrid){.kind = kind};
  TRY(fem_petsc_library(&multigrid->petsc));
  if (kind == FEM_PETSC_BOOMER && !fem_petsc_library_has_hypre())
    return status_fail(STATUS_IO,
                       "solver.linear: amg is BoomerAMG of hypre, which this PETSc was built without; "
                       "use gamg or cholmod");
  return set_options(multigrid);
}

static void forget(FemPetscMultigrid *multigrid) {
  if (multigrid->hierarchy) multigrid->petsc->PCDestroy(&multigrid->hierarchy);
  if (multigrid->view) multigrid->petsc->MatDestroy(&multigrid->view);
  fem_cycle_destroy(&multigrid->cycle);
  multigrid->hierarchy = NULL, multigrid->view = NULL;
  fem_vertex_matrix_destroy(&multigrid->matrix);
}

void fem_petsc_multigrid_clear(FemPetscMultigrid *multigrid) {
  forget(multigrid);
  if (multigrid->right_vec) multigrid->petsc->VecDestroy(&multigrid->right_vec);
  if (multigrid->left_vec) multigrid->petsc->VecDestroy(&multigrid->left_vec);
  memory_free(multigrid->right), memory_free(multigrid->left);
  multigrid->right = multigrid->left = NULL;
  multigrid->right_vec = multigrid->left_vec = NULL;
}

Status fem_petsc_multigrid_lay_out(FemPetscMultigrid *multigrid, int row_count) {
  const FemPetscLibrary *petsc = multigrid->petsc;
  multigrid->right = memory_zeroed((size_t)row_count, sizeof *multigrid->right);
  multigrid->left = memory_zeroed((size_t)row_count, sizeof *multigrid->left);
  if (!multigrid->right || !multigrid->left) return status_no_memory("the solver amg");
  PETSC_TRY("a vector",
            petsc->VecCreateSeqWithArray(petsc->self, 3, row_count, multigrid->right, &multigrid->right_vec));
  PETSC_TRY("a vector",
            petsc->VecCreateSeqWithArray(petsc->self, 3, row_count, multigrid->left, &multigrid->left_vec));
  return STATUS_OK;
}

// ---- A hierarchy.

static Status view_matrix(const FemPetscMultigrid *multigrid, const FemVertexMatrix *matrix, Mat *view) {
  const FemPetscLibrary *petsc = multigrid->petsc;
  PETSC_TRY("the matrix",
            petsc->MatCreateSeqAIJWithArrays(petsc->self, matrix->count, matrix->count, matrix->begin,
                                             matrix->column, matrix->value, view));
  PETSC_TRY("the matrix", petsc->MatSetBlockSize(*view, 3));
  PETSC_TRY("the matrix", petsc->MatSetOption(*view, MAT_SYMMETRIC, PETSC_TRUE));
  PETSC_TRY("the matrix", petsc->MatSetOption(*view, MAT_SPD, PETSC_TRUE));
  return STATUS_OK;
}

static Status set_up(FemPetscMultigrid *multigrid, const FemVertexRows *rows, Mat matrix) {
  const FemPetscLibrary *petsc = multigrid->petsc;
  const bool is_gamg = multigrid->kind == FEM_PETSC_GAMG;
  PETSC_TRY("the multigrid", petsc->PCCreate(petsc->self, &multigrid->hierarchy));
  PETSC_TRY("the multigrid", petsc->PCSetOptionsPrefix(multigrid->hierarchy, prefixes[multigrid->kind]));
  PETSC_TRY("the multigrid", petsc->PCSetType(multigrid->hierarchy, is_gamg ? PCGAMG : PCHYPRE));
  PETSC_TRY("the multigrid", petsc->PCSetOperators(multigrid->hierarchy, matrix, matrix));
  PETSC_TRY("the multigrid", petsc->PCSetFromOptions(multigrid->hierarchy));
  if (is_gamg && rows->rest)
    PETSC_TRY("the multigrid", petsc->PCSetCoordinates(multigrid->hierarchy, 3, rows->count / 3, rows->rest));
  PETSC_TRY("the multigrid", petsc->PCSetUp(multigrid->hierarchy));
  return STATUS_OK;
}

// hypre has a matrix of its own.
static Status convert(const FemPetscMultigrid *multigrid, const FemVertexMatrix *matrix, Mat *converted) {
  const FemPetscLibrary *petsc = multigrid->petsc;
  Mat view = NULL;
  Status status = view_matrix(multigrid, matrix, &view);
  if (!status) {
    PetscErrorCode code = petsc->MatConvert(view, MATHYPRE, MAT_INITIAL_MATRIX, converted);
    if (code) status = fail_in(multigrid, "the matrix", code);
  }
  if (view) petsc->MatDestroy(&view);
  return status;
}

static Status coarsen(FemPetscMultigrid *multigrid, const FemVertexRows *rows,
                      const FemVertexMatrix *matrix) {
  Mat converted = NULL;
  TRY(convert(multigrid, matrix, &converted));
  Status status = STATUS_OK;
  PetscErrorCode code = multigrid->petsc->MatSetBlockSize(converted, 3);
  if (code) status = fail_in(multigrid, "the matrix", code);
  if (!status) status = set_up(multigrid, rows, converted);
  multigrid->petsc->MatDestroy(&converted); // the multigrid has it
  return status;
}

// The hierarchy is hypre's, the work with it our own, so hypre's copies go.
static Status build_boomer(FemPetscMultigrid *multigrid, const FemVertexRows *rows, const FemMatrix *matrix) {
  FemVertexMatrix own = {0};
  PetscErrorCode code = 0;
  Status status = fem_vertex_matrix_fill(&own, rows, matrix, names[multigrid->kind]);
  if (!status) status = coarsen(multigrid, rows, &own);
  FemRows finest = {own.count, own.count, own.begin, own.column, own.value};
  if (!status)
    status = fem_hierarchy_take(multigrid->petsc, multigrid->hierarchy, &finest, &multigrid->cycle, &code);
  if (code) status = fail_in(multigrid, "the multigrid", code);
  if (multigrid->hierarchy) multigrid->petsc->PCDestroy(&multigrid->hierarchy);
  multigrid->hierarchy = NULL;
  fem_vertex_matrix_destroy(&own);
  return status;
}

static Status build_gamg(FemPetscMultigrid *multigrid, const FemVertexRows *rows, const FemMatrix *matrix) {
  TRY(fem_vertex_matrix_fill(&multigrid->matrix, rows, matrix, names[multigrid->kind]));
  TRY(view_matrix(multigrid, &multigrid->matrix, &multigrid->view));
  return set_up(multigrid, rows, multigrid->view);
}

Status fem_petsc_multigrid_build(FemPetscMultigrid *multigrid, const FemVertexRows *rows,
                                 const FemMatrix *matrix) {
  forget(multigrid);
  Status status = multigrid->kind == FEM_PETSC_BOOMER ? build_boomer(multigrid, rows, matrix)
                                                      : build_gamg(multigrid, rows, matrix);
  if (status) forget(multigrid);
  return status;
}

bool fem_petsc_multigrid_is_built(const FemPetscMultigrid *multigrid) {
  return multigrid->hierarchy || multigrid->cycle.levels;
}

// ---- Work with it.

static Status apply_gamg(FemPetscMultigrid *multigrid) {
  const FemPetscLibrary *petsc = multigrid->petsc;
  double *right; // PETSc is informed that its numbers have changed
  PETSC_TRY("a vector", petsc->VecGetArray(multigrid->right_vec, &right));
  PETSC_TRY("a vector", petsc->VecRestoreArray(multigrid->right_vec, &right));
  PETSC_TRY("the multigrid", petsc->PCApply(multigrid->hierarchy, multigrid->right_vec, multigrid->left_vec));
  return STATUS_OK;
}

Status fem_petsc_multigrid_apply(FemPetscMultigrid *multigrid) {
  if (multigrid->kind == FEM_PETSC_GAMG) return apply_gamg(multigrid);
  fem_cycle_apply(&multigrid->cycle, multigrid->right, multigrid->left);
  return STATUS_OK;
}
