// SPDX-License-Identifier: GPL-3.0-or-later
// Which linear solver a run gets, why, and the memory that it will take.
#ifndef TETLAP_FEM_RUN_CHECK_CHOICE_H
#define TETLAP_FEM_RUN_CHECK_CHOICE_H

#include "fem/effect/numbering.h"
#include "fem/sparse/solver.h"

typedef struct FemRunChoice {
  FemSolverKind kind; // never FEM_SOLVER_AUTO
  const char *why;    // of `auto`; "" where the scene says which
  double bytes;       // of the whole run, roughly
} FemRunChoice;

// Of a run as it begins; `now` not NULL: of one whose unknowns are those.
FemRunChoice fem_run_choice(const FemModel *model, const FemNumbering *now);

// The same of a run over so many ranks (base/ranks.h); `bytes` of each rank.
FemRunChoice fem_run_choice_over(const FemModel *model, int rank_count);

#endif
