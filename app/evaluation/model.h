// SPDX-License-Identifier: GPL-3.0-or-later
// Overlap models as commands name them (overlap/source.h); here `geo-constant` too, the frame of `geo`
// without a network.
#ifndef TETLAP_APP_EVALUATION_MODEL_H
#define TETLAP_APP_EVALUATION_MODEL_H

#include "app/evaluation/evaluation.h"

// Destroy it with overlap_model_destroy. STATUS_INPUT: neither a known name nor a file that holds a model.
Status app_evaluation_model_open(OverlapModel *model, const char *name);

// What the model says of a pair's status; NULL: it says nothing of that.
AppEvaluationLogits app_evaluation_model_logits(const OverlapModel *model);

#endif
