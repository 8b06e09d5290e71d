// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "app/scene/keys/choices.h"
#include "fem/scene/scene.h"

static const SceneKey load_keys[] = {
    {"force", SCENE_VECTOR, AT(FemLoadDef, vector),
     .excludes = "body_force traction pressure torque external", .unit = "N",
     MARK(FemLoadDef, kind, FEM_LOAD_FORCE), .help = "total, distributed evenly over the selected vertices"},
    {"body_force", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "force traction pressure torque",
     .unit = "N/m³", MARK(FemLoadDef, kind, FEM_LOAD_BODY_FORCE),
     .help = "on the volume (at rest) around the selected vertices"},
    {"traction", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "force body_force pressure torque",
     .unit = "N/m²", MARK(FemLoadDef, kind, FEM_LOAD_TRACTION),
     .help = "on the area (at rest) of the surface triangles whose three corners are selected"},
    {"pressure", SCENE_NUMBER, AT(FemLoadDef, pressure), .unit = "Pa",
     MARK(FemLoadDef, kind, FEM_LOAD_PRESSURE),
     .help = "on the same triangles, against their outward normal"},
    {"torque", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "force body_force traction pressure",
     .unit = "N m", MARK(FemLoadDef, kind, FEM_LOAD_TORQUE),
     .help = "moment about the centroid of the selected vertices, without a resultant; its direction stays, "
             "and its forces turn with the vertices"},
    {"external", SCENE_TRUE, .excludes = "force body_force traction pressure torque factor table",
     MARK(FemLoadDef, kind, FEM_LOAD_EXTERNAL),
     .help = "nodal forces that whoever steps the run sets (docs/python.md); zero until then"},
    {"follows", SCENE_CHOICE, AT(FemLoadDef, is_dead), .fallback = "surface",
     .choices = &app_scene_choices_followings, .needs = "pressure", .help = "what a pressure acts on"},
    {"factor", SCENE_FORMULA, AT(FemLoadDef, factor), .absent_help = "1", .excludes = "table external",
     .help = "the load is this function of t [s] times the value above"},
    {"table", SCENE_PROFILE, AT(FemLoadDef, table), .count_offset = offsetof(FemLoadDef, table_count),
     .absent_help = "1", .excludes = "factor external",
     .help = "or rows [t, factor], linear between them, constant before and after"},
    {0},
};
const SceneSection app_scene_keys_load = {.help = "an external load",
                                          .size = sizeof(FemLoadDef),
                                          .keys = load_keys,
                                          .more = &app_scene_keys_select,
                                          .one_of = "box halfspace radius normal group all",
                                          .some_of = "force body_force traction pressure torque external",
                                          PLACE(FemLoadDef, select.place)};
