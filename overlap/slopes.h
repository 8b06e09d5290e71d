// SPDX-License-Identifier: Apache-2.0
// First derivatives of V and x̄ by the coordinates of a pair: what derivatives of whole runs are made of.
#ifndef TETLAP_OVERLAP_SLOPES_H
#define TETLAP_OVERLAP_SLOPES_H

#include "overlap/model.h"

// Whether the model has them: by a centroid of its own with its derivatives, or by second derivatives of V.
bool overlap_slopes_are_there(const OverlapModel *model);

// Of a batch with V and ∇V wanted, ∂x̄/∂x (pair_count, 3, 24) into `slopes` as well; 0 where V is 0.
// STATUS_INPUT: the model has none.
Status overlap_slopes_eval(const OverlapModel *model, const OverlapBatch *batch, double *slopes);

#endif
