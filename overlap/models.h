// SPDX-License-Identifier: Apache-2.0
// Overlap models by name: the list of those there are, and what a word names (overlap/source.h).
#ifndef TETLAP_OVERLAP_MODELS_H
#define TETLAP_OVERLAP_MODELS_H

#include "overlap/model.h"

// The models there are, and how many.
const OverlapOps *const *overlap_models_list(int *count);

// Makes the model that a word names. STATUS_INPUT: unknown name; the message lists the known ones and the
// nearest.
Status overlap_models_create(OverlapModel *model, const char *word);

// The same with options for networks, and for `hybrid` the name or file of its network, which `hybrid=WORD`
// has itself; both may be NULL.
Status overlap_models_create_with(OverlapModel *model, const char *word, const char *weights,
                                  const OverlapOptions *options);

// Whether the model that a word names, or the network that it is used with, lacks_scale (overlap/ops.h).
bool overlap_models_lack_scale(const char *word);

#endif
