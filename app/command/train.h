// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap train`: a learned overlap model from a configuration.
#ifndef TETLAP_APP_COMMAND_TRAIN_H
#define TETLAP_APP_COMMAND_TRAIN_H

// Returns the exit code.
int app_train_run(int argument_count, char **arguments);

#endif
