// SPDX-License-Identifier: GPL-3.0-or-later
// The table of keys as JSON Schema (draft 7), from which editors complete and check scene files.
#ifndef TETLAP_APP_SCENE_SCHEMA_H
#define TETLAP_APP_SCENE_SCHEMA_H

#include "base/files/record.h"

Status app_scene_schema_record(Record *schema);

#endif
