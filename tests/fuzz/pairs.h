// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of tetrahedra as fuzz_pairs makes them, for other targets.
#ifndef TETLAP_TESTS_FUZZ_PAIRS_H
#define TETLAP_TESTS_FUZZ_PAIRS_H

#include <stdbool.h>

// Whether V, ∇V and what is checked of them stay within what doubles can hold.
bool fuzz_pairs_is_moderate(const double x[24]);

#endif
