// SPDX-License-Identifier: Apache-2.0
// Where the weights of learned models are.
#ifndef TETLAP_OVERLAP_WEIGHTS_H
#define TETLAP_OVERLAP_WEIGHTS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

// Whether a model's name is rather a path to a weights file: it has a dot or a slash.
bool overlap_weights_is_path(const char *name);

// What a weights file's network is for, by its shape. STATUS_INPUT, STATUS_IO, STATUS_MEMORY: unreadable.
typedef enum OverlapWeightsKind { OVERLAP_WEIGHTS_GEO, OVERLAP_WEIGHTS_TPN } OverlapWeightsKind;
Status overlap_weights_kind(const char *path, OverlapWeightsKind *kind);

// The file of a shipped model, found as base/files/data.h has it. STATUS_IO: it is not there, with a remedy;
// STATUS_INPUT: the path has `size` characters or more.
Status overlap_weights_find(const char *name, char *path, size_t size);

#endif
