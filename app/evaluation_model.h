// SPDX-License-Identifier: GPL-3.0-or-later
// Overlap models as commands name them: one of the table of contact/overlap.h, a weights file, or
// `geo-constant`, the frame of `geo` without a network.
#ifndef TETLAP_APP_EVALUATION_MODEL_H
#define TETLAP_APP_EVALUATION_MODEL_H

#include "contact/overlap.h"

// Destroy it with contact_overlap_destroy. STATUS_INPUT: neither a known name nor a file that holds a model.
Status app_evaluation_model_open(ContactOverlapModel *model, const char *name);

#endif
