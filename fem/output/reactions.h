// SPDX-License-Identifier: GPL-3.0-or-later
// What holds and drives a body: the force that each of its `fixed` and `driven` entries exerts on it, columns
// of history.csv and the array `reaction` of frames. It is what balances all other forces on the prescribed
// coordinates; the inertia of the driven vertices themselves is left out.
#ifndef TETLAP_FEM_OUTPUT_REACTIONS_H
#define TETLAP_FEM_OUTPUT_REACTIONS_H

#include "fem/effect/system.h"
#include "fem/output/history.h"

// Three columns for each entry: reaction_BODY_fixed_0_x_N …
Status fem_reactions_add_columns(FemHistory *history, const FemModel *model);

// Whether anything of a body is prescribed.
bool fem_reactions_any(const FemModel *model);

// Evaluates the forces, and fails as they do. `sums` (NULL: not wanted) gets three numbers for each entry, in
// the columns' order, and is moved on to behind the last [N]. `at` (NULL: not wanted) gets the reaction on
// each vertex (vertex_count, 3) [N].
Status fem_reactions_measure(FemSystem *system, const FemState *state, double **sums, double *at);

#endif
