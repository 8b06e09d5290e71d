// SPDX-License-Identifier: GPL-3.0-or-later
// The peak of one core of this machine: the bound of the roofline model (Williams, Waterman, Patterson 2009).
#ifndef TETLAP_LAB_PEAK_H
#define TETLAP_LAB_PEAK_H

#include <stdbool.h>

// Multiplications and additions a second [1/s] of independent fused multiply-adds in the widest vectors that
// the processor has, on one core, in float or double; the best of several rounds of milliseconds.
double lab_peak_measure(bool is_float);

#endif
