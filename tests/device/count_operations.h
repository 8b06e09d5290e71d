// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef TETLAP_TESTS_COUNT_OPERATIONS_H
#define TETLAP_TESTS_COUNT_OPERATIONS_H

#ifdef __cplusplus
extern "C" {
#endif

// Multiplications, additions, divisions and roots of the kernels of clipping on a pair, for V, V + ∇V, V + x̄:
// `counts` with a fused one twice, `instructions` once.
void count_operations(const double pair[24], double counts[3], double instructions[3]);

#ifdef __cplusplus
}
#endif

#endif
