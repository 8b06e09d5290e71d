// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap datagen`: makes a data set of labelled pairs of tetrahedra.
#ifndef TETLAP_APP_COMMAND_DATAGEN_H
#define TETLAP_APP_COMMAND_DATAGEN_H

#include "app/cli/command.h"

extern const AppCommand app_command_datagen;

#endif
