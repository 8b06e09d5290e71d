// SPDX-License-Identifier: GPL-3.0-or-later
// The table of keys as the manual's reference page (Markdown): docs/scene.md.
#ifndef TETLAP_APP_SCENE_MANUAL_H
#define TETLAP_APP_SCENE_MANUAL_H

#include <stdio.h>

#include "base/status.h"

Status app_scene_manual_print(FILE *stream);

#endif
