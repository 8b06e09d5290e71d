// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab ranks SCENE`: one run on several numbers of processes: work, memory, balance, what is sent.
#ifndef TETLAP_LAB_SCENE_RANKS_H
#define TETLAP_LAB_SCENE_RANKS_H

#include "app/cli/command.h"

extern const AppCommand lab_ranks;

#endif
