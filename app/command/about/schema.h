// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap schema [--markdown]`: the scene file's keys for editors and for people.
#ifndef TETLAP_APP_COMMAND_SCHEMA_H
#define TETLAP_APP_COMMAND_SCHEMA_H

#include "app/cli/command.h"

extern const AppCommand app_command_schema;

#endif
