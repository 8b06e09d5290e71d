// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab datagen`: labelled pairs a second, in memory and into a file.
#ifndef TETLAP_LAB_OVERLAP_DATAGEN_H
#define TETLAP_LAB_OVERLAP_DATAGEN_H

#include "app/cli/command.h"

extern const AppCommand lab_datagen;

#endif
