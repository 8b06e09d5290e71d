// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench scaling`: how the time of the overlap models grows with the number of pairs, and that of a
// step, phase by phase, with the number of vertices; with the exponent that fits best.
#ifndef TETLAP_APP_BENCH_SCALING_H
#define TETLAP_APP_BENCH_SCALING_H

#include "app/cli/command.h"

extern const AppCommand app_bench_scaling;

// The slope of the least-squares line through (ln size, ln seconds); NaN for fewer than two sizes. What is
// not positive is left out.
double app_bench_scaling_exponent(const double *sizes, const double *seconds, int count);

#endif
