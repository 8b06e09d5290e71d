// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that the formulas of a scene give numbers: their values become positions and forces.
#ifndef TETLAP_FEM_EFFECT_FORMULAS_H
#define TETLAP_FEM_EFFECT_FORMULAS_H

#include "fem/model/model.h"

// STATUS_INPUT: one of them, of a motion that goes on or of a load, is no number at that time; the message
// has its place in the scene, its text and the time.
Status fem_formulas_check(const FemModel *model, double time);

#endif
