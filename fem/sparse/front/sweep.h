// SPDX-License-Identifier: GPL-3.0-or-later
// Solutions with the columns of one front: of its panel, `own` columns of `height` rows, a column after the
// other, lower triangle first. In double precision or with the panel in single precision, which is half the
// memory to be read; vectors are double in both.
#ifndef TETLAP_FEM_SPARSE_FRONT_SWEEP_H
#define TETLAP_FEM_SPARSE_FRONT_SWEEP_H

#include <stddef.h>

typedef struct FemSweepPanel {
  int own, height;
  const double *values; // NULL: in single precision
  const float *rough;
} FemSweepPanel;

// x[begin, end) becomes that of L x = b, of the triangle of these columns.
void fem_sweep_forward(const FemSweepPanel *panel, int begin, int end, double *x);
// y[0, last − first) −= rows [first, last) of the columns [begin, end) times x[begin, end).
void fem_sweep_subtract(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *x,
                        double *y);
// x[begin, end) −= the columns [begin, end), of rows [first, last), times y[0, last − first).
void fem_sweep_project(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *y,
                       double *x);
// x[begin, end) becomes that of Lᵀ x = b, of the triangle of these columns.
void fem_sweep_backward(const FemSweepPanel *panel, int begin, int end, double *x);

#endif
