// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies and obstacles by their names, for the words of a gradient.
#ifndef TETLAP_APP_GRADIENT_NAMES_H
#define TETLAP_APP_GRADIENT_NAMES_H

#include <stddef.h>

#include "fem/scene/scene.h"

// The number of a name, `length` long, from `begin` to before `end`: bodies, then obstacles, in the scene's
// order. STATUS_INPUT lists those that are there.
Status app_gradient_find_name(const FemSceneDef *scene, const char *name, size_t length, int begin, int end,
                              int *number);

#endif
