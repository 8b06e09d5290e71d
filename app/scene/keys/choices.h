// SPDX-License-Identifier: GPL-3.0-or-later
// The closed sets of names that keys of a scene choose from (app/scene/keys/keys.h), each with a line of help
// for every name.
#ifndef TETLAP_APP_SCENE_KEYS_CHOICES_H
#define TETLAP_APP_SCENE_KEYS_CHOICES_H

#include "app/scene/keys/keys.h"

extern const SceneChoices app_scene_choices_laws, app_scene_choices_potentials, app_scene_choices_solvers,
    app_scene_choices_overlaps, app_scene_choices_elements, app_scene_choices_followings,
    app_scene_choices_orders_of_motion, app_scene_choices_outcomes, app_scene_choices_histories;

#endif
