// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab drop`: a block that falls onto the ground, for every contact stiffness and tolerance of a
// list: the largest gain of energy of the run, and the cost of keeping it low.
#ifndef TETLAP_LAB_SCENE_DROP_H
#define TETLAP_LAB_SCENE_DROP_H

#include "app/cli/command.h"

extern const AppCommand lab_drop;

#endif
