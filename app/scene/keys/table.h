// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the table of keys (app/scene/keys/keys.h), a file each, and how its lines are written. For
// those files only.
#ifndef TETLAP_APP_SCENE_KEYS_TABLE_H
#define TETLAP_APP_SCENE_KEYS_TABLE_H

#include <stddef.h>

#include "app/scene/keys/section.h"

// A field of a struct: offset and size.
#define AT(Type, field) offsetof(Type, field), sizeof(((Type *)0)->field)
// What a key marks when it is given.
#define MARK(Type, field, to) .mark = {AT(Type, field), to}
#define PLACE(Type, field) .has_place = true, .place_offset = offsetof(Type, field)

// A section without a place of its own has its keys in the same struct.
extern const SceneSection app_scene_keys_mesh;       // of bodies and obstacles, from their `mesh_path` on
extern const SceneSection app_scene_keys_mesh_place; // FemPlacement
extern const SceneSection app_scene_keys_material;   // FemMaterial
const char *app_scene_keys_material_finish(void *self, const char **key); // of what begins with one
extern const SceneSection app_scene_keys_select; // FemSelectDef, the first member of what selects
extern const SceneSection app_scene_keys_select_box, app_scene_keys_select_halfspace,
    app_scene_keys_select_radius;                // parts of it
extern const SceneSection app_scene_keys_motion; // FemConstraintDef, of an obstacle
extern const SceneSection app_scene_keys_motion_fixed, app_scene_keys_motion_driven; // of vertices
extern const SceneSection app_scene_keys_load;                                       // FemLoadDef
extern const SceneSection app_scene_keys_body;                                       // FemBodyDef
extern const SceneSection app_scene_keys_obstacle;                                   // FemObstacleDef
extern const SceneSection app_scene_keys_contact; // FemContactDef, from FemSceneDef
extern const SceneSection app_scene_keys_run_time, app_scene_keys_run_start, app_scene_keys_run_solver,
    app_scene_keys_run_output;

#endif
