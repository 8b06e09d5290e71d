// SPDX-License-Identifier: GPL-3.0-or-later
// V and ∇V of all models on a set of pairs: errors against the exact model, times in turns.
#ifndef TETLAP_LAB_PARETO_PAIRS_H
#define TETLAP_LAB_PARETO_PAIRS_H

#include "lab/pareto/pareto.h"

// Adds two points a model, and the comparisons that this set is for. `set`: one of app_bench_sets, static.
Status lab_pareto_pairs_measure(LabPareto *pareto, const char *set);

#endif
