// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab scene SCENE…`: whole runs of scenes, with each of several overlap models: wall and processor
// time, steps, and the time by phases (of the round whose wall time is the median, so that they add up).
// Nothing is written.
#ifndef TETLAP_LAB_SCENE_SCENE_H
#define TETLAP_LAB_SCENE_SCENE_H

#include "app/cli/command.h"

extern const AppCommand lab_scene;

#endif
