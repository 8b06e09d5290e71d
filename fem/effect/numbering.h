// SPDX-License-Identifier: GPL-3.0-or-later
// Which coordinates are unknowns now: those that are neither prescribed nor of a body that sleeps. It changes
// in a run when vertices are released and when bodies fall asleep or awake.
#ifndef TETLAP_FEM_EFFECT_NUMBERING_H
#define TETLAP_FEM_EFFECT_NUMBERING_H

#include "fem/model/model.h"

typedef struct FemNumbering {
  int count;           // of unknowns, n
  int *unknown_of_dof; // number of the unknown, −1: there is none               (3·vertex_count)
  int *dof_of_unknown; // 3·vertex + component                                   (n)
  bool *is_held;       // bodies that sleep: their vertices carry no unknowns    (body_count)
  double released;     // what is due until then has been released [s]
} FemNumbering;

// The numbering at the beginning: nothing is released, no body sleeps. A zeroed one, and one whose creation
// failed, can be destroyed.
Status fem_numbering_create(FemNumbering *numbering, const FemModel *model);
void fem_numbering_destroy(FemNumbering *numbering);

// Numbers the unknowns anew, after `is_held` or `released` has changed.
void fem_numbering_renew(FemNumbering *numbering, const FemModel *model);

// The next time after `time` at which vertices are released; INFINITY: none.
double fem_numbering_next_release(const FemModel *model, double time);

#endif
