// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap eval`: how well an overlap model answers a data set.
#ifndef TETLAP_APP_EVAL_COMMAND_H
#define TETLAP_APP_EVAL_COMMAND_H

// Returns the exit code.
int app_eval_run(int argument_count, char **arguments);

#endif
