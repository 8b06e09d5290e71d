// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab step SCENE`: where the time of a run goes, one row a phase.
#ifndef TETLAP_LAB_SCENE_STEP_H
#define TETLAP_LAB_SCENE_STEP_H

#include "app/cli/command.h"

extern const AppCommand lab_step;

#endif
