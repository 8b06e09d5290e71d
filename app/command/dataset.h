// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap dataset info|merge|plot`: what to do with data set files.
#ifndef TETLAP_APP_COMMAND_DATASET_H
#define TETLAP_APP_COMMAND_DATASET_H

// arguments[0] is "tetlap dataset"; returns the exit code.
int app_dataset_run(int argument_count, char **arguments);

#endif
