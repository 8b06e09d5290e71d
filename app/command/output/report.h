// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap report DIR…`: a web page about one run or several.
#ifndef TETLAP_APP_COMMAND_REPORT_H
#define TETLAP_APP_COMMAND_REPORT_H

#include "app/cli/command.h"

extern const AppCommand app_command_report;

#endif
