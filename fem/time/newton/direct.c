// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/direct.h"

#include "fem/time/sundials.h"

static SUNLinearSolver_Type type_of(SUNLinearSolver linear) {
  (void)linear;
  return SUNLINEARSOLVER_DIRECT;
}

static SUNLinearSolver_ID id_of(SUNLinearSolver linear) {
  (void)linear;
  return SUNLINEARSOLVER_CUSTOM;
}

static SUNMatrix_ID matrix_id_of(SUNMatrix matrix) {
  (void)matrix;
  return SUNMATRIX_CUSTOM;
}

// Assembly zeroes its matrices itself.
static int zero_matrix(SUNMatrix matrix) {
  (void)matrix;
  return SUN_SUCCESS;
}

Status fem_direct_create(FemDirect *direct, SUNContext context, void *content, FemDirectSetUp *set_up,
                         FemDirectSolve *solve) {
  *direct = (FemDirect){.linear = SUNLinSolNewEmpty(context), .matrix = SUNMatNewEmpty(context)};
  if (!direct->linear || !direct->matrix) return status_no_memory("the linear solver");
  direct->linear->content = content;
  direct->linear->ops->gettype = type_of;
  direct->linear->ops->getid = id_of;
  direct->linear->ops->setup = set_up;
  direct->linear->ops->solve = solve;
  direct->matrix->ops->getid = matrix_id_of;
  direct->matrix->ops->zero = zero_matrix;
  return STATUS_OK;
}

void fem_direct_destroy(FemDirect *direct) {
  if (direct->linear) SUNLinSolFreeEmpty(direct->linear);
  if (direct->matrix) SUNMatFreeEmpty(direct->matrix);
  *direct = (FemDirect){0};
}

int fem_direct_flag(int answer) {
  return answer == 0 ? SUN_SUCCESS : answer > 0 ? SUNLS_PACKAGE_FAIL_REC : SUN_ERR_EXT_FAIL;
}
