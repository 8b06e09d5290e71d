// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/dominance.h"

#include <math.h>
#include <string.h>

static const double MOST_BESIDE = 0.3; // e

// Σ |K_ij| over j ≠ i of each row.
static void add_rows(const FemMatrix *matrix, double *rows) {
  memset(rows, 0, (size_t)matrix->size * sizeof *rows);
  for (int column = 0; column < matrix->size; column++)
    for (int k = matrix->col_begin[column] + 1; k < matrix->col_begin[column + 1]; k++) {
      double size = fabs(matrix->value[k]);
      rows[column] += size;
      rows[matrix->row[k]] += size;
    }
}

double fem_dominance_least(const FemSystem *system, const FemMatrix *stiffness, const int *places,
                           double *rows) {
  double most = 0;
  add_rows(stiffness, rows);
  for (int i = 0; i < system->numbering.count; i++) {
    int place = places ? places[i] : i;
    double own = stiffness->value[stiffness->col_begin[place]];
    double mass = system->model->mass[system->numbering.dof_of_unknown[i] / 3];
    most = fmax(most, (rows[place] / MOST_BESIDE - own) / mass);
  }
  return sqrt(most);
}
