// SPDX-License-Identifier: Apache-2.0
// An overlap model as it was made (overlap/models.h; overlap/ops.h says what one is): what it can give, and
// batches evaluated with OpenMP.
#ifndef TETLAP_OVERLAP_MODEL_H
#define TETLAP_OVERLAP_MODEL_H

#include "overlap/ops.h"

typedef struct OverlapModel {
  const OverlapOps *ops;
  void *self; // owned
} OverlapModel;

// Whether pairs without common interior may get a volume.
bool overlap_model_has_ghosts(const OverlapModel *model);

// Whether it has second derivatives.
bool overlap_model_has_hessian(const OverlapModel *model);

// Whether it has a centroid of its own; that of others follows from V and ∇V (overlap/pair/centroid.h).
bool overlap_model_has_own_centroid(const OverlapModel *model);

// Whether it has first derivatives.
bool overlap_model_has_gradient(const OverlapModel *model);

// Whether it wants the origins of pairs.
bool overlap_model_wants_origins(const OverlapModel *model);

// Evaluates all pairs of the batch with OpenMP. STATUS_INPUT: a coordinate is NaN or infinite; the message
// names the pair. STATUS_INPUT: a gradient, centroid or Hessian is asked of a model that has none. Where x̄
// follows from ∇V and the batch has no place for ∇V, that is allocated for the call.
Status overlap_model_eval(const OverlapModel *model, const OverlapBatch *batch);

void overlap_model_destroy(OverlapModel *model);

#endif
