// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap pareto [SCENE…]`: error against time of every overlap model and of a sweep of network sizes.
#ifndef TETLAP_APP_COMMAND_PARETO_H
#define TETLAP_APP_COMMAND_PARETO_H

// Runs the command; arguments[0] is what the usage line begins with. Returns the exit code.
int app_pareto_run(int argument_count, char **arguments);

#endif
