// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap view`: a run in a browser, also while it goes on.
#ifndef TETLAP_APP_COMMAND_VIEW_H
#define TETLAP_APP_COMMAND_VIEW_H

#include "app/cli/command.h"

extern const AppCommand app_command_view;

#endif
