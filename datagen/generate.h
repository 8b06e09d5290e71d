// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of a plan, drawn, proven and labelled, into arrays.
#ifndef TETLAP_DATAGEN_GENERATE_H
#define TETLAP_DATAGEN_GENERATE_H

#include "datagen/law/plan.h"
#include "datagen/pairs.h"

// Makes pairs `first` … `first` + `count` − 1 of the plan over OpenMP threads; the result does not depend on
// their number. `pairs->gradient` and `pairs->centroid` may be NULL, the other arrays are the caller's. Adds
// to `attempts`, by kind, how many candidates were drawn.
Status datagen_generate(const DatagenPlan *plan, long long first, int count, const DatagenPairs *pairs,
                        long long attempts[DATAGEN_KIND_COUNT]);

// V and, unless they are NULL, ∇V and x̄ of one pair of whose intersection the dimension is proven: exactly
// zero below 3.
Status datagen_generate_label(DatagenLabel label, const double pair[24], int dimension, double *volume,
                              double *gradient, double *centroid);

#endif
