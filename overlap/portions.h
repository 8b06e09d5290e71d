// SPDX-License-Identifier: Apache-2.0
// A batch over OpenMP threads, portion by portion. The division does not depend on the number of threads, and
// each pair has its own place in the outputs, so neither do the results.
#ifndef TETLAP_OVERLAP_PORTIONS_H
#define TETLAP_OVERLAP_PORTIONS_H

#include "overlap/ops.h"

// Evaluates one portion, whose first pair is number `first` of the batch. Called from several threads at
// once.
typedef Status (*OverlapPortionEval)(const void *self, const OverlapBatch *portion, int first);

// Portions of `size` pairs, handed out as threads get free; in the calling thread alone unless `is_parallel`.
// If some fail, the status and the message are those of the first of them.
Status overlap_portions_eval(const OverlapBatch *batch, int size, bool is_parallel, OverlapPortionEval eval,
                             const void *self);

#endif
