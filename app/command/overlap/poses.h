// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap poses`: overlap volume and wrench of many poses of one of a scene's bodies.
#ifndef TETLAP_APP_COMMAND_POSES_H
#define TETLAP_APP_COMMAND_POSES_H

#include "app/cli/command.h"

extern const AppCommand app_command_poses;

#endif
