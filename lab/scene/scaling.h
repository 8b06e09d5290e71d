// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab scaling`: how the time of the overlap models grows with the number of pairs, and that of a
// step, phase by phase, with the number of vertices; with the exponent that fits best.
#ifndef TETLAP_LAB_SCENE_SCALING_H
#define TETLAP_LAB_SCENE_SCALING_H

#include "app/cli/command.h"

extern const AppCommand lab_scaling;

// The slope of the least-squares line through (ln size, ln seconds); NaN for fewer than two sizes. What is
// not positive is left out.
double lab_scaling_exponent(const double *sizes, const double *seconds, int count);

#endif
