// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap schema [--markdown]`: the scene file's keys for editors and for people.
#ifndef TETLAP_APP_COMMAND_SCHEMA_H
#define TETLAP_APP_COMMAND_SCHEMA_H

int app_schema_run(int argument_count, char **arguments);

#endif
