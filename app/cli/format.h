// SPDX-License-Identifier: GPL-3.0-or-later
// The layout of the JSON files that runs and comparisons write, as a number under `format`: what the keys are
// called and mean. It goes up when a key that someone may read changes; CHANGELOG.md lists old and new names.
#ifndef TETLAP_APP_CLI_FORMAT_H
#define TETLAP_APP_CLI_FORMAT_H

#include "base/files/record.h"
#include "base/status.h"

enum { APP_FORMAT = 1 };

void app_format_record(Record *record); // adds the key

// Whether this program reads what DIRECTORY/NAME holds. STATUS_INPUT says which format it has, which program
// wrote it (`program`, "0.1.0"; NULL: not known) and what to do. `record` NULL: no such file, which is no
// failure.
Status app_format_check(const Record *record, const char *directory, const char *name, const char *program);

#endif
