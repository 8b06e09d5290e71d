// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef TETLAP_TESTS_COUNT_OPERATIONS_H
#define TETLAP_TESTS_COUNT_OPERATIONS_H

#ifdef __cplusplus
extern "C" {
#endif

// Multiplications, additions, divisions and roots (a fused one counts twice) of the kernels of clipping on a
// pair, for V, V + ∇V, V + x̄.
void count_operations(const double pair[24], double counts[3]);

#ifdef __cplusplus
}
#endif

#endif
