// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap resume`: continues a run from its last checkpoint.
#ifndef TETLAP_APP_COMMAND_RESUME_H
#define TETLAP_APP_COMMAND_RESUME_H

#include "app/cli/command.h"

extern const AppCommand app_command_resume;

#endif
