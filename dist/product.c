// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/product.h"

#include "base/memory.h"
#include "dist/entries.h"

static void clear(DistProduct *product) {
  for (int k = 0; k < product->rows->own_count; k++) product->y[product->rows->own[k]] = 0;
  for (int k = 0; k < product->reach->other_count; k++) product->y[product->reach->others[k]] = 0;
}

// `in`: of this rank's rows; `others` has come already.
static PetscErrorCode take_in(DistProduct *product, const double *in) {
  const DistRows *rows = product->rows;
  const double *others;
  for (int k = 0; k < rows->own_count; k++)
    product->x[rows->own[k]] = in[rows->row[rows->own[k]] - rows->first];
  PetscCall(VecGetArrayRead(product->others, &others));
  for (int k = 0; k < product->reach->other_count; k++) product->x[product->reach->others[k]] = others[k];
  PetscCall(VecRestoreArrayRead(product->others, &others));
  return 0;
}

// y to its rows' owners, which add it to their own.
static PetscErrorCode give_out(DistProduct *product, const double *in, Vec out_vec) {
  const DistRows *rows = product->rows;
  double *out, *others;
  PetscCall(VecGetArrayWrite(out_vec, &out));
  for (int k = 0; k < rows->own_count; k++)
    out[rows->row[rows->own[k]] - rows->first] = product->y[rows->own[k]];
  for (int k = 0; k < rows->alone_count; k++) {
    int row = rows->alone[k] - rows->first;
    out[row] = product->alone * (in ? in[row] : 1);
  }
  PetscCall(VecRestoreArrayWrite(out_vec, &out));
  PetscCall(VecGetArrayWrite(product->others, &others));
  for (int k = 0; k < product->reach->other_count; k++) others[k] = product->y[product->reach->others[k]];
  PetscCall(VecRestoreArrayWrite(product->others, &others));
  PetscCall(VecScatterBegin(product->scatter, product->others, out_vec, ADD_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(product->scatter, product->others, out_vec, ADD_VALUES, SCATTER_REVERSE));
  return 0;
}

static PetscErrorCode multiply(Mat shell, Vec in_vec, Vec out_vec) {
  DistProduct *product;
  const double *in;
  PetscCall(MatShellGetContext(shell, &product));
  PetscCall(VecScatterBegin(product->scatter, in_vec, product->others, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(product->scatter, in_vec, product->others, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(in_vec, &in));
  PetscCall(take_in(product, in));
  clear(product);
  fem_matrix_add_product(product->matrix, product->reach->vertex_count, product->reach->vertices, product->x,
                         product->y);
  PetscCall(give_out(product, in, out_vec));
  PetscCall(VecRestoreArrayRead(in_vec, &in));
  return 0;
}

PetscErrorCode dist_product_diagonal(DistProduct *product, Vec diagonal) {
  const FemMatrix *matrix = product->matrix;
  const DistRows *rows = product->rows;
  const DistReach *reach = product->reach;
  for (int k = 0; k < rows->own_count; k++)
    product->y[rows->own[k]] = matrix->value[matrix->col_begin[rows->own[k]]];
  for (int k = 0; k < reach->other_count; k++)
    product->y[reach->others[k]] = matrix->value[matrix->col_begin[reach->others[k]]];
  return give_out(product, NULL, diagonal);
}

static PetscErrorCode make_scatter(DistProduct *product, Vec like) {
  const DistReach *reach = product->reach;
  int *from = memory_zeroed((size_t)reach->other_count, sizeof *from);
  IS rows_of_others;
  if (!from) return PETSC_ERR_MEM;
  for (int k = 0; k < reach->other_count; k++) from[k] = product->rows->row[reach->others[k]];
  PetscErrorCode code =
      ISCreateGeneral(PETSC_COMM_SELF, reach->other_count, from, PETSC_COPY_VALUES, &rows_of_others);
  memory_free(from);
  PetscCall(code);
  PetscCall(VecScatterCreate(like, rows_of_others, product->others, NULL, &product->scatter));
  return ISDestroy(&rows_of_others);
}

PetscErrorCode dist_product_create(DistProduct *product, const DistRows *rows, const DistReach *reach,
                                   Vec like, double *x) {
  *product = (DistProduct){.rows = rows, .reach = reach, .x = x};
  product->y = memory_zeroed((size_t)rows->size, sizeof *product->y);
  if (!product->y) return PETSC_ERR_MEM;
  int own = rows->end - rows->first;
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, reach->other_count, &product->others));
  PetscCall(make_scatter(product, like));
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, own, own, rows->count, rows->count, product, &product->shell));
  PetscCall(MatShellSetOperation(product->shell, MATOP_MULT, (void (*)(void))multiply));
  PetscCall(MatSetBlockSize(product->shell, 3));
  PetscCall(MatSetOption(product->shell, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatSetOption(product->shell, MAT_SPD, PETSC_TRUE));
  return 0;
}

void dist_product_destroy(DistProduct *product) {
  if (product->shell) MatDestroy(&product->shell);
  if (product->scatter) VecScatterDestroy(&product->scatter);
  if (product->others) VecDestroy(&product->others);
  memory_free(product->y);
  *product = (DistProduct){0};
}

void dist_product_set(DistProduct *product, const FemMatrix *matrix) {
  product->matrix = matrix;
  product->alone = dist_entries_alone(product->rows, matrix);
}
