// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "app/scene/keys/choices.h"
#include "fem/scene/scene.h"

static const SceneSection inner = {.help = "faces that are not contact surface",
                                   .size = sizeof(FemInnerDef),
                                   .keys = (const SceneKey[]){{0}},
                                   .more = &app_scene_keys_select,
                                   .one_of = "box halfspace radius normal group all",
                                   PLACE(FemInnerDef, select.place)};

static const SceneKey probe_keys[] = {
    {"name", SCENE_LABEL, AT(FemProbeDef, name), .required = "foot", .help = "its name in columns"},
    {0},
};
static const SceneSection probe = {.help = "output for a part of a body",
                                   .size = sizeof(FemProbeDef),
                                   .keys = probe_keys,
                                   .more = &app_scene_keys_select,
                                   .one_of = "box halfspace radius normal group all",
                                   PLACE(FemProbeDef, select.place)};

static const SceneKey line_keys[] = {
    {"name", SCENE_LABEL, AT(FemLineDef, name), .required = "middle", .help = "its name in the file"},
    {"from", SCENE_VECTOR, AT(FemLineDef, from), .unit = "m", .required = "[0, 0, 0]",
     .help = "the first point, as placed, at rest"},
    {"to", SCENE_VECTOR, AT(FemLineDef, to), .unit = "m", .required = "[0, 0, 0.1]",
     .help = "the last; points outside go to the surface if that is within a fifth of an element's edge, "
             "others are left out"},
    {"points", SCENE_INTEGER, AT(FemLineDef, points), .range = "[2, 10000]", .fallback = "51",
     .help = "evenly from one end to the other"},
    {0},
};
static const SceneSection line = {.help = "output along a straight line through a body or on its surface",
                                  .size = sizeof(FemLineDef),
                                  .keys = line_keys,
                                  PLACE(FemLineDef, place)};

_Static_assert(offsetof(FemPartDef, material) == 0, "the keys of a material count from it");

// Whole tetrahedra: what lies on a surface is none.
static const SceneKey part_keys[] = {
    {"group", SCENE_TEXT, AT(FemPartDef, select.group), MARK(FemPartDef, select.kind, FEM_SELECT_GROUP),
     .help = "its tetrahedra: those of a named group of the mesh, as of a physical volume of gmsh"},
    {"box", SCENE_SECTION, .offset = offsetof(FemPartDef, select), .section = &app_scene_keys_select_box,
     MARK(FemPartDef, select.kind, FEM_SELECT_BOX),
     .help = "those with their middle in a box, as placed, at rest"},
    {"halfspace", SCENE_SECTION, .offset = offsetof(FemPartDef, select),
     .section = &app_scene_keys_select_halfspace, MARK(FemPartDef, select.kind, FEM_SELECT_HALFSPACE),
     .help = "those with their middle on one side of a plane"},
    {"radius", SCENE_SECTION, .offset = offsetof(FemPartDef, select),
     .section = &app_scene_keys_select_radius, MARK(FemPartDef, select.kind, FEM_SELECT_RADIUS),
     .help = "those with their middle at a distance from an axis or a point"},
    {0},
};
static const SceneSection part = {.help = "a part of a body that is made of something else",
                                  .size = sizeof(FemPartDef),
                                  .keys = part_keys,
                                  .more = &app_scene_keys_material,
                                  .one_of = "group box halfspace radius",
                                  PLACE(FemPartDef, select.place),
                                  .finish = app_scene_keys_material_finish};

static const SceneKey body_keys[] = {
    {"name", SCENE_LABEL, AT(FemBodyDef, name), .required = "block",
     .help = "its name in messages and outputs"},
    {"mesh", SCENE_SECTION, .offset = offsetof(FemBodyDef, mesh_path), .required = "block.msh",
     .section = &app_scene_keys_mesh,
     .help = "its tetrahedra: the path of a file, or a mapping with more options"},
    {"place", SCENE_SECTION, AT(FemBodyDef, placement), .section = &app_scene_keys_mesh_place,
     .help = "position of the mesh"},
    {"material", SCENE_SECTION, AT(FemBodyDef, material),
     .absent_help = "none: every tetrahedron is in one of `materials`", .section = &app_scene_keys_material,
     .help = "constitutive law and parameters, {young: 1e6, poisson: 0.4, density: 1000} at least"},
    {"materials", SCENE_LIST, AT(FemBodyDef, parts), .section = &part,
     .count_offset = offsetof(FemBodyDef, part_count),
     .help = "of parts that are made of something else, each with all keys of a material; `material` is that "
             "of the rest. No tetrahedron may be in two parts"},
    {"element", SCENE_CHOICE, AT(FemBodyDef, element), .fallback = "linear",
     .choices = &app_scene_choices_elements, .help = "element formulation"},
    {"self_contact", SCENE_SWITCH, AT(FemBodyDef, self_contact), .fallback = "false",
     .help =
         "its parts may touch each other; needs `contact`. Elements that share a vertex or overlap at rest "
         "never touch"},
    {"velocity", SCENE_VECTOR, AT(FemBodyDef, velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .help = "at t = 0"},
    {"spin", SCENE_VECTOR, AT(FemBodyDef, spin), .unit = "rad/s", .fallback = "[0, 0, 0]",
     .help = "angular velocity about the centre of mass at t = 0"},
    {"fixed", SCENE_LIST, AT(FemBodyDef, fixed), .section = &app_scene_keys_motion_fixed,
     .count_offset = offsetof(FemBodyDef, fixed_count), .help = "vertices that do not move"},
    {"driven", SCENE_LIST, AT(FemBodyDef, driven), .section = &app_scene_keys_motion_driven,
     .count_offset = offsetof(FemBodyDef, driven_count), .help = "vertices with prescribed motion"},
    {"loads", SCENE_LIST, AT(FemBodyDef, loads), .section = &app_scene_keys_load,
     .count_offset = offsetof(FemBodyDef, load_count), .help = "external forces and pressures"},
    {"inner_faces", SCENE_LIST, AT(FemBodyDef, inner), .section = &inner,
     .count_offset = offsetof(FemBodyDef, inner_count),
     .help = "parts of its boundary that are not contact surface: planes of symmetry, glued faces; faces "
             "with all corners selected. At most 8; used by the potential `field`"},
    {"probes", SCENE_LIST, AT(FemBodyDef, probes), .section = &probe,
     .count_offset = offsetof(FemBodyDef, probe_count),
     .help =
         "parts of it whose force, moment, mean pressure, area and displacement are columns of history.csv "
         "and in the summary"},
    {"lines", SCENE_LIST, AT(FemBodyDef, lines), .section = &line,
     .count_offset = offsetof(FemBodyDef, line_count),
     .help = "lines that it carries: displacements, stresses and contact pressure of a line's points in each "
             "frame are in lines_NNNNN.csv"},
    {0},
};
const SceneSection app_scene_keys_body = {.help = "an elastic body",
                                          .size = sizeof(FemBodyDef),
                                          .keys = body_keys,
                                          .some_of = "material materials",
                                          PLACE(FemBodyDef, place)};
