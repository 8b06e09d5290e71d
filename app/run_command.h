// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap run SCENE`: runs a scene and writes what a person can open.
#ifndef TETLAP_APP_RUN_COMMAND_H
#define TETLAP_APP_RUN_COMMAND_H

int app_run_run(int argument_count, char **arguments);

#endif
