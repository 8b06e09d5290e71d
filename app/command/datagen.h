// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap datagen`: makes a data set of labelled pairs of tetrahedra.
#ifndef TETLAP_APP_COMMAND_DATAGEN_H
#define TETLAP_APP_COMMAND_DATAGEN_H

// arguments[0] is "tetlap datagen"; returns the exit code.
int app_datagen_run(int argument_count, char **arguments);

#endif
