// SPDX-License-Identifier: GPL-3.0-or-later
// METIS: divides a graph among ranks, the same way every time.
#ifndef TETLAP_DIST_DIVISION_H
#define TETLAP_DIST_DIVISION_H

#include "base/ranks.h"

Status dist_division_divide(const RanksGraph *graph, int rank_count, int *rank_of_node);

#endif
