// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap eval`: how well an overlap model answers a data set.
#ifndef TETLAP_APP_COMMAND_EVAL_H
#define TETLAP_APP_COMMAND_EVAL_H

// Returns the exit code.
int app_eval_run(int argument_count, char **arguments);

#endif
