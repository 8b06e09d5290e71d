// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab beam`: the same whole run of a beam with each linear solver: forces, assembly,
// factorisations, solutions, and the integrator's own work, up to a number of steps. A row's
// ratio is its wall time over that of the first row.
#ifndef TETLAP_LAB_SCENE_BEAM_H
#define TETLAP_LAB_SCENE_BEAM_H

#include "app/cli/command.h"

extern const AppCommand lab_beam;

#endif
