// SPDX-License-Identifier: GPL-3.0-or-later
// V and ∇V of all models on a set of pairs: errors against the exact model, times in turns.
#ifndef TETLAP_APP_PARETO_PAIRS_H
#define TETLAP_APP_PARETO_PAIRS_H

#include "app/pareto/pareto.h"

// Adds two points a model, and the comparisons that this set is for. `set`: one of app_bench_sets, static.
Status app_pareto_pairs_measure(AppPareto *pareto, const char *set);

#endif
