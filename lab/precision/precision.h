// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab precision SCENE…`: work and precision of whole runs (Hairer, Nørsett, Wanner 1993, II.10):
// every overlap model at every tolerance on every mesh level, its error against a reference at a far smaller
// tolerance on the same mesh and, where the levels differ, on the finest one; and what each model costs in
// steps.
#ifndef TETLAP_LAB_PRECISION_PRECISION_H
#define TETLAP_LAB_PRECISION_PRECISION_H

#include "app/cli/command.h"

extern const AppCommand lab_precision;

#endif
