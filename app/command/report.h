// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap report DIR…`: a web page about one run or two.
#ifndef TETLAP_APP_COMMAND_REPORT_H
#define TETLAP_APP_COMMAND_REPORT_H

int app_report_command_run(int argument_count, char **arguments); // returns the exit code

#endif
