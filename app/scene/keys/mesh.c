// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "fem/scene/scene.h"

// Bodies and obstacles keep these fields in the same order, so one table serves both.
#define IN_MESH(field)                                                                                       \
  offsetof(FemBodyDef, field) - offsetof(FemBodyDef, mesh_path), sizeof(((FemBodyDef *)0)->field)
#define SAME_IN_MESH(field)                                                                                  \
  _Static_assert(offsetof(FemBodyDef, field) - offsetof(FemBodyDef, mesh_path) ==                            \
                     offsetof(FemObstacleDef, field) - offsetof(FemObstacleDef, mesh_path),                  \
                 "bodies and obstacles must lay out their meshes alike")
SAME_IN_MESH(box_size);
SAME_IN_MESH(box_cells);
SAME_IN_MESH(mesh_options);
SAME_IN_MESH(mesh_place);

static const SceneKey mesh_box_keys[] = {
    {"size", SCENE_VECTOR, IN_MESH(box_size), .unit = "m", .range = "(0, inf)", .required = "[0.2, 0.2, 0.2]",
     .help = "edges; the box is [0, size] before it is placed"},
    {"cells", SCENE_COUNTS, IN_MESH(box_cells), .range = "[1, 10000]", .required = "[4, 4, 4]",
     .help = "cubes along each edge, of six tetrahedra each; one number stands for three"},
    {0},
};
static const SceneSection mesh_box = {.help = "a box cut into tetrahedra", .keys = mesh_box_keys};

static const SceneKey mesh_keys[] = {
    {"file", SCENE_TEXT, IN_MESH(mesh_path),
     .help = "path from the scene file: .msh, .mesh, .vtk, .node/.ele, with tetrahedra of 4 or 10 nodes; "
             ".stl and "
             ".geo are meshed in place"},
    {"size", SCENE_NUMBER, IN_MESH(mesh_options.size), .range = "(0, inf)", .absent_help = "gmsh's choice",
     .needs = "file", .help = "edge length for meshing .stl and .geo, in the file's units"},
    {"curved", SCENE_SWITCH, IN_MESH(mesh_options.is_curved), .fallback = "false", .needs = "file",
     .help =
         "of `element: quadratic`, where the file has straight edges: edges on curved parts of the surface "
         "follow it, as estimated from the vertices about them; `contact.crease` says which stay sharp"},
    {"box", SCENE_SECTION, .section = &mesh_box, .help = "a box in place of a file"},
    {0},
};
const SceneSection app_scene_keys_mesh = {.help = "tetrahedra: a file, or a box",
                                          .keys = mesh_keys,
                                          .shorthand = "file",
                                          .one_of = "file box",
                                          .has_place = true,
                                          .place_offset = offsetof(FemBodyDef, mesh_place) -
                                                          offsetof(FemBodyDef, mesh_path)};

static const SceneKey rotate_keys[] = {
    {"axis", SCENE_DIRECTION, AT(FemPlacement, axis), .required = "[0, 0, 1]", .help = "through the origin"},
    {"degrees", SCENE_NUMBER, AT(FemPlacement, angle_degrees), .unit = "°", .required = "30",
     .help = "counter-clockwise seen against the axis"},
    {0},
};
static const SceneSection rotate = {.help = "a rotation about an axis", .keys = rotate_keys};

static const SceneKey place_keys[] = {
    {"scale", SCENE_FACTORS, AT(FemPlacement, scale), .fallback = "1",
     .help = "first: a factor, or one for each axis; negative ones mirror"},
    {"rotate", SCENE_SECTION, .absent_help = "no turn", .section = &rotate, .help = "then"},
    {"translate", SCENE_VECTOR, AT(FemPlacement, translate), .unit = "m", .fallback = "[0, 0, 0]",
     .help = "last"},
    {0},
};
const SceneSection app_scene_keys_mesh_place = {.help = "scaled, then rotated, then translated",
                                                .keys = place_keys};
